#include "io/table/text_format.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "core/error.h"
#include "core/text.h"
#include "io/table/text_lines.h"

namespace strata {
namespace {

/// The names that --columns knows, besides extra:NAME.
constexpr std::array<std::string_view, 25> kColumnNames{"x",
                                                        "y",
                                                        "z",
                                                        "intensity",
                                                        "r",
                                                        "g",
                                                        "b",
                                                        "red",
                                                        "green",
                                                        "blue",
                                                        "nx",
                                                        "ny",
                                                        "nz",
                                                        "nir",
                                                        "classification",
                                                        "gps_time",
                                                        "return_number",
                                                        "number_of_returns",
                                                        "user_data",
                                                        "point_source_id",
                                                        "scan_angle_rank",
                                                        "scan_angle",
                                                        "flags",
                                                        "i",
                                                        "-"};

struct Alias {
  std::string_view written;
  std::string_view name;
};
constexpr std::array<Alias, 12> kAliases{{{"easting", "x"},
                                          {"east", "x"},
                                          {"northing", "y"},
                                          {"north", "y"},
                                          {"height", "z"},
                                          {"elevation", "z"},
                                          {"altitude", "z"},
                                          {"i", "intensity"},
                                          {"class", "classification"},
                                          {"gpstime", "gps_time"},
                                          {"returnnumber", "return_number"},
                                          {"numberofreturns", "number_of_returns"}}};

/// The name of a column, given as it is written in the file: `X [m]` is x. Unknown names stay as they are.
std::string columnName(std::string_view written) {
  std::string_view bare = written.substr(0, written.find_first_of("([{"));
  while (bare.ends_with(' ')) bare.remove_suffix(1);
  while (bare.starts_with(' ')) bare.remove_prefix(1);
  const std::string lower = lowerCase(bare);
  for (const Alias& alias : kAliases)
    if (lower == alias.written) return std::string(alias.name);
  if (std::find(kColumnNames.begin(), kColumnNames.end(), lower) != kColumnNames.end()) return lower;
  std::string name;
  for (const char c : bare) name += std::isprint(static_cast<unsigned char>(c)) ? c : '_';
  return name.empty() ? "-" : name;
}

/// Calls `fail` for each of x, y and z that is not there exactly once.
template <typename Failure>
void checkAxes(const std::vector<std::string>& columns, const Failure& fail) {
  for (const char* axis : {"x", "y", "z"}) {
    const auto found = std::count(columns.begin(), columns.end(), axis);
    if (found != 1) fail("column " + std::string(axis), std::to_string(found));
  }
}

std::vector<std::string> parseColumnOption(const std::string& option) {
  std::vector<std::string> columns;
  for (std::size_t at = 0; at <= option.size();) {
    const std::size_t comma = std::min(option.find(',', at), option.size());
    const std::string name = option.substr(at, comma - at);
    at = comma + 1;
    const std::string lower = lowerCase(name);
    if (lower.starts_with("extra:") && lower.size() > 6) {
      columns.push_back(name.substr(6));
    } else if (std::find(kColumnNames.begin(), kColumnNames.end(), lower) != kColumnNames.end()) {
      columns.push_back(lower == "i" ? "intensity" : lower);
    } else {
      throw UsageError("--columns: unknown column '" + name +
                       "' (expected x, y, z, intensity, r, g, b, nx, ny, nz, classification, gps_time, ..., " +
                       "extra:NAME, or - to skip one)");
    }
  }
  checkAxes(columns, [](const std::string& what, const std::string& found) {
    throw UsageError("--columns: " + what + " found " + found + " times (expected once)");
  });
  return columns;
}

std::vector<std::string> guessColumns(std::size_t count) {
  std::vector<std::string> columns{"x", "y", "z"};
  if (count == 4 || count == 7 || count == 10) columns.push_back("intensity");
  if (count >= 6 && count <= 10 && count != 8) columns.insert(columns.end(), {"r", "g", "b"});
  if (count == 9 || count == 10) columns.insert(columns.end(), {"nx", "ny", "nz"});
  while (columns.size() < count) columns.push_back("column" + std::to_string(columns.size() + 1));
  return columns;
}

bool isNumber(std::string_view token) {
  double ignored = 0.0;
  return parseNumber(token, ignored);
}

class FormatDetector {
 public:
  FormatDetector(const std::string& file, std::string_view head, const std::string& option) : file_(file), head_(head) {
    if (!option.empty()) {
      format_.columns = parseColumnOption(option);
      format_.named = true;
    }
  }

  TextFormat run() {
    if (head_.starts_with("\xEF\xBB\xBF")) at_ = 3;  // a byte order mark
    bool counted = false;
    for (; at_ < head_.size(); advance()) {
      lineEnd_ = std::min(head_.find('\n', at_), head_.size());
      if (lookAt(head_.substr(at_, lineEnd_ - at_), counted)) {
        format_.headerBytes = counted ? countAt_ : at_;
        format_.firstLine = counted ? countLine_ : lineNumber_;
        return format_;
      }
    }
    throw Error(file_, "found no line of numbers (expected x, y, z)");
  }

 private:
  void advance() {
    at_ = lineEnd_ + 1;
    ++lineNumber_;
  }

  /// True when `line` is the first point.
  bool lookAt(std::string_view line, bool& counted) {
    const std::size_t start = line.find_first_not_of(" \t\r");
    if (start == std::string_view::npos) return false;
    line.remove_prefix(start);
    const bool comment = line.starts_with('#') || line.starts_with("//");
    if (comment) line.remove_prefix(std::min(line.find_first_not_of("#/"), line.size()));
    splitColumns(line, tokens_);
    if (comment) {
      takeNames(true);
      return false;
    }
    if (tokens_.size() == 1 && !counted && isCount(tokens_[0])) {
      counted = true;
      countAt_ = at_;
      countLine_ = lineNumber_;
      format_.countLines = true;
      return false;
    }
    if (!isNumber(firstValue())) {
      takeNames(false);
      return false;
    }
    if (line.find(';') != std::string_view::npos && line.find(',') != std::string_view::npos)
      throw Error(file_, "line " + std::to_string(lineNumber_) +
                             ": found commas and semicolons (expected one separator and decimal points)");
    if (format_.columns.empty()) {
      if (tokens_.size() < 3)
        throw Error(file_, "line " + std::to_string(lineNumber_) + ": found " + std::to_string(tokens_.size()) +
                               " columns (expected at least 3)");
      format_.columns = guessColumns(tokens_.size());
    }
    return true;
  }

  /// The token of the first column that is read.
  std::string_view firstValue() const {
    std::size_t column = 0;
    while (column < format_.columns.size() && format_.columns[column] == "-") ++column;
    return column < tokens_.size() ? tokens_[column] : std::string_view();
  }

  static bool isCount(std::string_view token) {
    return std::all_of(token.begin(), token.end(), [](char c) { return c >= '0' && c <= '9'; }) && !token.empty();
  }

  /// Takes a line of names. Comments that are no such line are passed over.
  void takeNames(bool comment) {
    if (format_.named) return;
    std::vector<std::string> names;
    for (const std::string_view token : tokens_) names.push_back(columnName(token));
    bool whole = true;
    std::string missing;
    checkAxes(names, [&](const std::string& what, const std::string&) {
      if (whole) missing = what;
      whole = false;
    });
    if (whole) {
      format_.columns = std::move(names);
      format_.named = true;
    } else if (!comment) {
      throw Error(file_, "line " + std::to_string(lineNumber_) + ": found names without " + missing +
                             " (expected x, y and z once each; --columns x,y,z,... names the columns)");
    }
  }

  const std::string& file_;
  std::string_view head_;
  TextFormat format_;
  std::size_t at_ = 0;
  std::size_t lineEnd_ = 0;
  std::uint64_t lineNumber_ = 1;
  std::size_t countAt_ = 0;
  std::uint64_t countLine_ = 1;
  std::vector<std::string_view> tokens_;
};

}  // namespace

TextFormat detectTextFormat(const std::string& file, std::string_view head, const std::string& columns) {
  return FormatDetector(file, head, columns).run();
}

}  // namespace strata
