#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/box.h"
#include "io/file/byte_source.h"
#include "io/scan/point_source.h"
#include "io/table/field.h"

namespace strata {

/// What happens to one column of a line.
struct TextColumn {
  enum class Kind : std::uint8_t {
    skip,
    value,   ///< a number of the field
    packed,  ///< a colour of 4 bytes, written as an integer or as the float that has its bits
    list     ///< a count n and n more columns, none of them kept (PLY)
  };
  Kind kind = Kind::value;
  std::size_t field = 0;  ///< index into TextTable::fields
  std::size_t value = 0;  ///< index of the value within the field
};

/// Points as lines of numbers within a file: the body of text scans and of ascii PLY and PCD.
struct TextTable {
  std::string format;               ///< for SourceInfo
  std::vector<TextColumn> columns;  ///< a line may have more, they are ignored
  std::vector<Field> fields;        ///< of the record that a line becomes
  std::size_t recordBytes = 0;
  bool comments = false;    ///< lines that start with # or // are none
  bool countLines = false;  ///< lines of a single integer are none (PTS, one before each scan)
  const std::atomic<bool>* stop = nullptr;
  bool skipDamaged = false;  ///< lines that cannot be read are left out instead of refused
  std::uint64_t begin = 0;   ///< bytes of the file, both at line starts
  std::uint64_t end = 0;
  std::uint64_t firstLine = 1;          ///< number of the line at `begin`
  std::uint64_t claimedPoints = 0;      ///< as a header says; 0 when none does
  std::optional<glm::dvec3> viewpoint;  ///< for SourceInfo
};

/// The range of bytes that one reader takes, at line starts.
struct TextPart {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  std::uint64_t firstLine = 1;
  std::uint64_t points = 0;
  std::uint64_t damaged = 0;  ///< lines left out
};

/// How the values of a column are written, over the whole table.
struct ColumnSurvey {
  FieldRange range;
  bool integers = true;  ///< no value has a decimal point, an exponent or is not finite
  int digits = 0;        ///< most significant digits in a value
  int decimals = 0;      ///< most digits behind the decimal point, without zeros at the end, exponents counted in
};

/// What one pass over the table finds.
struct TextSurvey {
  std::vector<TextPart> parts;
  std::vector<ColumnSurvey> columns;  ///< one a column
  Box bounds;                         ///< of the points whose coordinates are all finite
  std::uint64_t points = 0;
  std::uint64_t damaged = 0;
};

/// Passes over the table in parallel. Throws Error naming the line that cannot be read, the first of the file's.
/// A count line that promises another number of points than follow is an error too.
TextSurvey surveyText(const ByteSource& bytes, const TextTable& table);

/// Opens a table whose fields are set as a source; `survey` is surveyText() of it. SourceInfo::pointCount counts
/// damaged lines too, and is TextTable::claimedPoints when that is more.
std::unique_ptr<PointSource> openTextTable(std::unique_ptr<ByteSource> bytes, TextTable table, TextSurvey survey);

/// Gives fields their offsets, packed in order, and the table its recordBytes.
void packFields(TextTable& table);

/// The byte after `lines` lines that are not blank, from `begin` on; `found` is how many there were, `lineNumber` is
/// raised by the lines passed over, blank ones too.
std::uint64_t skipLines(const ByteSource& bytes, std::uint64_t begin, std::uint64_t lines, std::uint64_t& found,
                        std::uint64_t& lineNumber);

}  // namespace strata
