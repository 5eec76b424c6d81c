#include "io/table/pcd_source.h"

#include <algorithm>
#include <cctype>
#include <span>
#include <string_view>

#include "core/error.h"
#include "io/file/byte_source.h"
#include "io/table/pcd_header.h"
#include "io/table/pcl_source.h"
#include "io/table/record_source.h"
#include "io/table/text_table.h"

namespace strata {
namespace {

constexpr std::uint64_t kHeadBytes = 1 << 20;

bool isNamed(const Field& field, std::initializer_list<std::string_view> names) {
  std::string lower;
  for (const char c : field.name) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(names.begin(), names.end(), lower) != names.end();
}

std::unique_ptr<PointSource> openAscii(std::unique_ptr<ByteSource> bytes, const PcdHeader& header, bool skipDamaged) {
  TextTable table;
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
  std::uint64_t found = 0;
  std::uint64_t line = table.firstLine;
  table.end = skipLines(*bytes, table.begin, header.points, found, line);
  if (found < header.points && !skipDamaged)
    throw Error(bytes->name(), "the file ends early, found " + std::to_string(found) + " points (expected " +
                                   std::to_string(header.points) + ")");
  TextSurvey survey = surveyText(*bytes, table);
  return openTextTable(std::move(bytes), std::move(table), std::move(survey), header.points, "PCD ascii");
}

PcdHeader readHeader(const std::string& path, const ByteSource& bytes) {
  std::string head(static_cast<std::size_t>(std::min(bytes.size(), kHeadBytes)), '\0');
  bytes.read(0, std::as_writable_bytes(std::span(head)));
  return parsePcdHeader(path, head);
}

}  // namespace

std::optional<glm::dvec3> pcdViewpoint(const std::string& path) { return readHeader(path, *openFile(path)).viewpoint; }

std::unique_ptr<PointSource> openPcd(const std::string& path, const SourceOptions& options) {
  std::unique_ptr<ByteSource> bytes = openFile(path);
  const PcdHeader header = readHeader(path, *bytes);
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
                                        .fields = header.fields});
}

}  // namespace strata
