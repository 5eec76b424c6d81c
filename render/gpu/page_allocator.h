#pragma once
#include <cstdint>
#include <map>
#include <optional>

namespace strata {

/// Hands out ranges of one page, first fit, neighbours joined again when they are free.
class PageAllocator {
 public:
  explicit PageAllocator(std::uint32_t words);

  /// First word of a free range of `words`, at least 1; none where no range is long enough.
  std::optional<std::uint32_t> allocate(std::uint32_t words);
  /// Gives a range back, exactly as it was allocated.
  void release(std::uint32_t firstWord, std::uint32_t words);

  std::uint32_t freeWords() const { return freeWords_; }
  std::uint32_t longestFree() const;

 private:
  std::map<std::uint32_t, std::uint32_t> free_;  ///< first word to length; no two touch
  std::uint32_t freeWords_;
};

}  // namespace strata
