#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/file/byte_source.h"
#include "io/table/text_table.h"

namespace strata {

/// The lines of a range of a file, read in large blocks. A line ends with \n, \r\n or the end of the range.
class LineReader {
 public:
  static constexpr std::size_t kBlockBytes = std::size_t{1} << 20;
  static constexpr std::size_t kLongestLine = std::size_t{1} << 20;

  LineReader(const ByteSource& bytes, std::uint64_t begin, std::uint64_t end)
      : bytes_(bytes), next_(begin), end_(end) {}

  /// The next line without its end, valid until the next call; false at the end of the range. Throws Error for a line
  /// longer than kLongestLine.
  bool next(std::string_view& line);
  /// Lines handed out so far.
  std::uint64_t count() const { return count_; }
  /// Where the line after the last one handed out starts.
  std::uint64_t offset() const { return next_ - (buffer_.size() - at_); }

 private:
  bool fill();

  const ByteSource& bytes_;
  std::uint64_t next_;  ///< file offset of what follows the buffer
  std::uint64_t end_;
  std::vector<char> buffer_;
  std::size_t at_ = 0;  ///< start of the next line in the buffer
  std::uint64_t count_ = 0;
};

/// Splits at runs of blanks and at commas and semicolons with blanks around; `tokens` is replaced. Quotes around a
/// token are taken off; blanks and separators within them belong to it. Empty tokens stand between neighbouring commas.
void splitColumns(std::string_view line, std::vector<std::string_view>& tokens);

/// The first 32 letters of a word for a message, with a question mark for each that cannot be printed.
std::string shownWord(std::string_view word);

/// A token as a number; false where it is none. A leading + is allowed, as are nan and inf.
bool parseNumber(std::string_view token, double& value);
bool parseInteger(std::string_view token, std::int64_t& value);

/// Writes a number as a value of `type`; false where it does not fit. Integers may be written as 3.0.
bool storeNumber(std::string_view token, ScalarType type, std::byte* out);

/// Blank lines and, where the table has such, comments and count lines carry no point.
enum class LineKind : std::uint8_t { point, blank, countLine };
LineKind lineKind(std::string_view line, const TextTable& table);

/// Picks the tokens of the table's columns (an empty one for lists) into `picked`, one for each column. False where
/// the line has too few.
bool pickColumns(const std::vector<std::string_view>& tokens, const TextTable& table,
                 std::vector<std::string_view>& picked);

/// Turns lines into records. Keeps its memory from line to line.
class LineParser {
 public:
  explicit LineParser(const TextTable& table) : table_(table), record_(table.recordBytes) {}

  /// False where the line cannot be read; fault() then says why.
  bool parse(std::string_view line);
  const std::vector<std::byte>& record() const { return record_; }
  /// Tokens of the table's columns of the line parsed last.
  const std::vector<std::string_view>& columns() const { return picked_; }
  /// `found 2 columns (expected 3)`.
  std::string fault() const;

 private:
  const TextTable& table_;
  std::vector<std::byte> record_;
  std::vector<std::string_view> tokens_;
  std::vector<std::string_view> picked_;
  int badColumn_ = -1;  ///< of `picked_`; -1 = too few columns
};

}  // namespace strata
