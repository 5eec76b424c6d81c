#pragma once
#include <cstdint>
#include <map>
#include <optional>

namespace strata {

/// Hands out ranges of one page by first fit. Free neighbours are joined again.
class PageAllocator {
 public:
  explicit PageAllocator(std::uint32_t words);

  /// Takes a range of `words` words, at least 1, and returns its first. Nothing where no free range is long enough.
  std::optional<std::uint32_t> allocate(std::uint32_t words);
  /// Gives back a whole range that allocate() returned.
  void release(std::uint32_t firstWord, std::uint32_t words);

  std::uint32_t freeWords() const { return freeWords_; }
  std::uint32_t longestFree() const;

 private:
  std::map<std::uint32_t, std::uint32_t> free_;  ///< length by first word; no two ranges touch
  std::uint32_t freeWords_;
};

}  // namespace strata
