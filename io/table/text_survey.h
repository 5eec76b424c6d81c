#pragma once
#include <cstdint>
#include <vector>

#include "core/box.h"
#include "io/file/byte_source.h"
#include "io/table/field.h"
#include "io/table/text_table.h"

namespace strata {

/// A part of a table: a range of bytes from the start of one line to the start of another.
struct TextPart {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  std::uint64_t firstLine = 1;  ///< number in the file
  std::uint64_t points = 0;
  std::uint64_t damaged = 0;  ///< lines left out
};

/// How the numbers of one column are written, over the whole table.
struct ColumnSurvey {
  FieldRange range;
  bool integers = true;  ///< every number is finite and has no decimal point or exponent
  int digits = 0;        ///< most significant digits of a number
  int decimals = 0;      ///< most digits behind the decimal point, exponents counted in, zeros at the end left out
};

/// The findings of one pass over a table.
struct TextSurvey {
  std::vector<TextPart> parts;
  std::vector<ColumnSurvey> columns;  ///< one for each column
  Box bounds;                         ///< of the points whose coordinates are all finite
  std::uint64_t points = 0;
  std::uint64_t damaged = 0;  ///< lines left out
};

/// Reads the whole table once, on all cores. Throws Error naming the first line of the file that cannot be read, or a
/// count line that promises another number of points than follow. Throws Stopped.
TextSurvey surveyText(const ByteSource& bytes, const TextTable& table);

}  // namespace strata
