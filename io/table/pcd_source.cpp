#include "io/table/pcd_source.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "core/error.h"
#include "core/text.h"
#include "io/file/byte_source.h"
#include "io/table/compressed_pcd.h"
#include "io/table/pcd_header.h"
#include "io/table/record_source.h"
#include "io/table/text_lines.h"
#include "io/table/text_survey.h"
#include "io/table/text_table.h"
#include "io/table/text_table_source.h"

namespace strata {
namespace {

constexpr std::uint64_t kHeadBytes = 1 << 20;

bool isNamed(const Field& field, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), lowerCase(field.name)) != names.end();
}

std::unique_ptr<PointSource> openAscii(std::unique_ptr<ByteSource> bytes, const PcdHeader& header, bool skipDamaged) {
  TextTable table;
  table.format = "PCD ascii";
  table.claimedPoints = header.points;
  table.viewpoint = header.viewpoint;
  table.skipDamaged = skipDamaged;
  table.begin = header.headerBytes;
  table.firstLine = header.headerLines + 1;
  table.fields = header.fields;
  for (std::size_t i = 0; i < table.fields.size(); ++i) {
    Field& field = table.fields[i];
    const bool packed = field.count == 1 && scalarBytes(field.type) == 4 && isNamed(field, {"rgb", "rgba"});
    const TextColumn::Kind kind = field.name == "_" ? TextColumn::Kind::skip
                                  : packed          ? TextColumn::Kind::packed
                                                    : TextColumn::Kind::value;
    for (std::uint32_t value = 0; value < field.count; ++value) table.columns.push_back({kind, i, value});
    if (field.type == ScalarType::f32 && isNamed(field, {"x", "y", "z"})) field.type = ScalarType::f64;
  }
  packFields(table);
  const SkippedLines body = skipLines(*bytes, table.begin, header.points, table.firstLine);
  table.end = body.end;
  if (body.points < header.points && !skipDamaged)
    throw Error(bytes->name(), "the file ends early, found " + std::to_string(body.points) + " points (expected " +
                                   std::to_string(header.points) + ")");
  TextSurvey survey = surveyText(*bytes, table);
  return openTextTable(std::move(bytes), std::move(table), std::move(survey));
}

}  // namespace

std::unique_ptr<PointSource> openPcd(const std::string& path, const SourceOptions& options) {
  std::unique_ptr<ByteSource> bytes = openFile(path);
  const PcdHeader header = parsePcdHeader(path, readBeginning(*bytes, kHeadBytes));
  switch (header.encoding) {
    case PcdEncoding::ascii:
      return openAscii(std::move(bytes), header, options.skipDamaged);
    case PcdEncoding::binaryCompressed:
      return openCompressedPcd(std::move(bytes), header, options.memoryBytes / 4);
    case PcdEncoding::binary:
      break;
  }
  return openRecords(std::move(bytes), {.format = "PCD binary",
                                        .dataOffset = header.headerBytes,
                                        .pointCount = header.points,
                                        .recordBytes = header.recordBytes,
                                        .bigEndian = false,
                                        .skipDamaged = options.skipDamaged,
                                        .fields = header.fields,
                                        .viewpoint = header.viewpoint});
}

}  // namespace strata
