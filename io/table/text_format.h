#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace strata {

/// How a text scan is laid out, as far as its first lines tell.
struct TextFormat {
  std::vector<std::string> columns;  ///< names, `-` for one that is skipped
  bool named = false;                ///< by the file's header line or the user, not guessed from their number
  bool countLines = false;           ///< the first line counts the points (PTS)
  std::uint64_t headerBytes = 0;     ///< before the first line of the table
  std::uint64_t firstLine = 1;       ///< its number
};

/// Looks at the first bytes of a text scan. Separators are blanks, tabs, commas and semicolons; lines may end with
/// \r\n. A line of names (with or without // or # in front) names the columns; it is needed for other numbers of
/// columns than 3 (x y z), 4 (and intensity), 6 (x y z r g b), 7 (x y z intensity r g b), 9 and 10 (these and nx ny
/// nz); otherwise columns after the third are called column4, column5, ... (Six columns are x y z nx ny nz where
/// openText finds the last three to be fractions within -1..1.) `columns` is what the user says instead:
/// "x,y,z,intensity,r,g,b", with `-` for a column to skip and extra:NAME for an attribute of one's own. Throws Error
/// naming `file`, UsageError for a wrong `columns`.
TextFormat detectTextFormat(const std::string& file, std::string_view head, const std::string& columns);

}  // namespace strata
