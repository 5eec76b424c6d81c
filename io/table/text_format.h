#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace strata {

/// The layout of a text scan, as far as its first lines tell it.
struct TextFormat {
  std::vector<std::string> columns;  ///< names; `-` for a column that is skipped
  bool named = false;                ///< the names come from the file or the user, and are not guessed
  bool countLines = false;           ///< the first line counts the points (PTS)
  std::uint64_t headerBytes = 0;     ///< before the first line of the table
  std::uint64_t firstLine = 1;       ///< number of that line
};

/// Finds the layout from the first bytes of a text scan. Columns are separated by blanks, tabs, commas or semicolons,
/// and lines may end with \r\n. A line of names, with or without // or # before it, names the columns. Without one, the
/// number of columns does: 3 are x y z, 4 are x y z intensity, 6 are x y z r g b, 7 are x y z intensity r g b, and 9
/// and 10 are the last two with nx ny nz at the end. Otherwise the columns after the third are called column4, column5
/// and so on. (openText() takes six columns for x y z nx ny nz when the last three are fractions within -1..1.)
///
/// `columns` is the user's list of names, or empty: "x,y,z,intensity,r,g,b", with `-` for a column to skip and
/// extra:NAME for an attribute of any name. Throws Error naming `file`, and UsageError for a wrong `columns`.
TextFormat detectTextFormat(const std::string& file, std::string_view head, const std::string& columns);

}  // namespace strata
