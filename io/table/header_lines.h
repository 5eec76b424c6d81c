#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace strata {

/// The text header of a PLY or PCD file, taken line by line, so that every error names its line.
class HeaderLines {
 public:
  /// `file` is the name for errors and `head` the beginning of the file. Both must outlive the object.
  HeaderLines(const std::string& file, std::string_view head) : file_(file), head_(head) {}

  /// Splits the next line into words; false when `head` has no further whole line.
  bool next();
  const std::vector<std::string_view>& words() const { return words_; }
  /// The bytes and the lines taken so far.
  std::size_t bytes() const { return bytes_; }
  std::size_t lines() const { return lines_; }

  /// Throws Error `FILE: line 7: what`.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  const std::string& file_;
  std::string_view head_;
  std::vector<std::string_view> words_;
  std::size_t bytes_ = 0, lines_ = 0;
};

}  // namespace strata
