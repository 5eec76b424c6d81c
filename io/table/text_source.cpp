#include "io/table/text_source.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <span>
#include <string_view>

#include "core/error.h"
#include "io/file/byte_source.h"
#include "io/table/record_mapping.h"
#include "io/table/text_format.h"
#include "io/table/text_survey.h"
#include "io/table/text_table.h"
#include "io/table/text_table_source.h"

namespace strata {
namespace {

constexpr std::uint64_t kHeadBytes = 256 << 10;  ///< comments and names must fit in here
constexpr int kFloat32Digits = 6;                ///< digits that a float keeps

bool fits(const ColumnSurvey& column, ScalarType type) {
  if (!column.integers || column.range.empty()) return false;
  switch (type) {
    case ScalarType::u8:
      return column.range.min >= 0.0 && column.range.max <= 255.0;
    case ScalarType::i8:
      return column.range.min >= -128.0 && column.range.max <= 127.0;
    case ScalarType::u16:
      return column.range.min >= 0.0 && column.range.max <= 65535.0;
    case ScalarType::i16:
      return column.range.min >= -32768.0 && column.range.max <= 32767.0;
    case ScalarType::i32:
      return column.range.min >= -2147483648.0 && column.range.max <= 2147483647.0;
    case ScalarType::i64:
      return column.range.min >= -9e15 && column.range.max <= 9e15;
    default:
      return false;
  }
}

/// The smallest type that loses nothing of the numbers in a column.
ScalarType columnType(const std::string& name, const ColumnSurvey& column) {
  if (name == "x" || name == "y" || name == "z") return ScalarType::f64;
  if (const auto known = knownFieldType(name))
    if (*known == ScalarType::f32 || *known == ScalarType::f64 || fits(column, *known)) return *known;
  if (fits(column, ScalarType::i32)) return ScalarType::i32;
  if (fits(column, ScalarType::i64)) return ScalarType::i64;
  return column.digits <= kFloat32Digits ? ScalarType::f32 : ScalarType::f64;
}

/// Gives all colours one type: when one of them is a fraction, a 1 in another means full light.
void matchColours(std::vector<Field>& fields) {
  std::vector<Field*> colours;
  for (Field& field : fields)
    for (const std::string_view name : {"r", "g", "b", "red", "green", "blue"})
      if (field.name == name) colours.push_back(&field);
  if (std::any_of(colours.begin(), colours.end(), [](const Field* field) { return field->type == ScalarType::f32; }))
    for (Field* field : colours) field->type = ScalarType::f32;
}

bool looksLikeNormals(const std::vector<ColumnSurvey>& columns, std::size_t first) {
  bool whole = true;
  for (std::size_t c = first; c < first + 3; ++c) {
    if (columns[c].range.empty() || columns[c].range.min < -1.0 || columns[c].range.max > 1.0) return false;
    whole = whole && columns[c].integers;
  }
  const double lowest =
      std::min({columns[first].range.min, columns[first + 1].range.min, columns[first + 2].range.min});
  return !whole && lowest < 0.0;
}

std::string formatName(const std::string& path) {
  std::string name = std::filesystem::path(path).extension().string();
  if (name.starts_with('.')) name.erase(0, 1);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
  return name.empty() ? "text" : name + " text";
}

}  // namespace

std::unique_ptr<PointSource> openText(const std::string& path, const SourceOptions& options) {
  std::unique_ptr<ByteSource> bytes = openFile(path);
  const TextFormat format = detectTextFormat(path, readBeginning(*bytes, kHeadBytes), options.columns);

  TextTable table;
  table.format = formatName(path);
  for (const std::string& name : format.columns) {
    const bool skipped = name == "-";
    table.columns.push_back({skipped ? TextColumn::Kind::skip : TextColumn::Kind::value, table.fields.size()});
    if (!skipped) table.fields.push_back({.name = name, .type = ScalarType::f64});
  }
  table.comments = true;
  table.countLines = format.countLines;
  table.skipDamaged = options.skipDamaged;
  table.stop = options.stop;
  table.begin = format.headerBytes;
  table.end = bytes->size();
  table.firstLine = format.firstLine;
  packFields(table);

  TextSurvey survey = surveyText(*bytes, table);
  if (!format.named && format.columns.size() == 6 && looksLikeNormals(survey.columns, 3))
    for (std::size_t axis = 0; axis < 3; ++axis) table.fields[3 + axis].name = std::string("n") + "xyz"[axis];
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (table.columns[c].kind == TextColumn::Kind::skip) continue;
    Field& field = table.fields[table.columns[c].field];
    field.type = columnType(field.name, survey.columns[c]);
  }
  matchColours(table.fields);
  packFields(table);
  return openTextTable(std::move(bytes), std::move(table), std::move(survey));
}

}  // namespace strata
