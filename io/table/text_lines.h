#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/file/byte_source.h"
#include "io/table/text_table.h"

namespace strata {

/// The lines of a range of a file, read in blocks of a megabyte. A line ends with \n, \r\n or the end of the range.
class LineReader {
 public:
  static constexpr std::size_t kBlockBytes = std::size_t{1} << 20;
  static constexpr std::size_t kLongestLine = std::size_t{1} << 20;

  LineReader(const ByteSource& bytes, std::uint64_t begin, std::uint64_t end)
      : bytes_(bytes), next_(begin), end_(end) {}

  /// Gives the next line without its end, valid until the next call; returns false at the end of the range. Throws
  /// Error for a line longer than kLongestLine.
  bool next(std::string_view& line);
  /// Number of lines handed out so far.
  std::uint64_t count() const { return count_; }
  /// Offset in the file of the line after the last one handed out.
  std::uint64_t offset() const { return next_ - (buffer_.size() - at_); }

 private:
  bool fill();

  const ByteSource& bytes_;
  std::uint64_t next_;  ///< file offset of the byte behind the buffer
  std::uint64_t end_;
  std::vector<char> buffer_;
  std::size_t at_ = 0;  ///< start of the next line in the buffer
  std::uint64_t count_ = 0;
};

/// Splits a line at runs of blanks, and at commas and semicolons with blanks around them; `tokens` is replaced. Quotes
/// around a token are taken off, and blanks and separators between them belong to it. Two neighbouring commas have an
/// empty token between them.
void splitColumns(std::string_view line, std::vector<std::string_view>& tokens);

/// The first 32 letters of a word for a message, with a question mark for each that cannot be printed.
std::string shownWord(std::string_view word);

/// Reads a whole token as a number; false when it is none. A leading + is allowed, and so are nan and inf.
bool parseNumber(std::string_view token, double& value);
bool parseInteger(std::string_view token, std::int64_t& value);

/// Stores a token at `out` as a number of `type`; false when it is none or does not fit. An integer may be written as
/// 3.0.
bool storeNumber(std::string_view token, ScalarType type, std::byte* out);

/// A blank line or comment, a line that counts points, or a point.
enum class LineKind : std::uint8_t { point, blank, countLine };
LineKind lineKind(std::string_view line, const TextTable& table);

/// The result of skipLines().
struct SkippedLines {
  std::uint64_t end = 0;       ///< offset in the file of the line after them
  std::uint64_t points = 0;    ///< how many there were, blank lines not counted
  std::uint64_t nextLine = 0;  ///< number of the line at `end`
};
/// Passes over `points` lines that are not blank from the offset `begin` on, where line number `firstLine` starts, or
/// to the end of the file.
SkippedLines skipLines(const ByteSource& bytes, std::uint64_t begin, std::uint64_t points, std::uint64_t firstLine);

/// Picks the tokens of the table's columns into `picked`, one for each column and an empty one for each list. False
/// when the line has too few.
bool pickColumns(const std::vector<std::string_view>& tokens, const TextTable& table,
                 std::vector<std::string_view>& picked);

/// Turns lines into records. It keeps its memory from line to line.
class LineParser {
 public:
  explicit LineParser(const TextTable& table) : table_(table), record_(table.recordBytes) {}

  /// Returns false when the line cannot be read; fault() then says why.
  bool parse(std::string_view line);
  const std::vector<std::byte>& record() const { return record_; }
  /// The tokens of the table's columns in the line parsed last.
  const std::vector<std::string_view>& columns() const { return picked_; }
  /// `found 2 columns (expected 3)`.
  std::string fault() const;

 private:
  const TextTable& table_;
  std::vector<std::byte> record_;
  std::vector<std::string_view> tokens_;
  std::vector<std::string_view> picked_;
  int badColumn_ = -1;  ///< index into `picked_`; -1 for too few columns
};

}  // namespace strata
