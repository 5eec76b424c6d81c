#include "io/table/ply_source.h"

#include <algorithm>
#include <span>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "io/file/byte_source.h"
#include "io/table/ply_header.h"
#include "io/table/record_source.h"
#include "io/table/text_lines.h"
#include "io/table/text_survey.h"
#include "io/table/text_table.h"
#include "io/table/text_table_source.h"

namespace strata {
namespace {

constexpr std::uint64_t kHeadBytes = 1 << 20;
constexpr std::size_t kWindowBytes = 1 << 16;

/// Passes over elements with lists, whose sizes only the counts in them tell.
class ListWalker {
 public:
  ListWalker(const ByteSource& bytes, std::uint64_t offset, bool bigEndian)
      : bytes_(bytes), at_(offset), bigEndian_(bigEndian) {}

  std::uint64_t skip(const PlyElement& element) {
    if (element.properties.empty()) return at_;
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const PlyProperty& property : element.properties)
        advance(property.countType ? listBytes(property) : scalarBytes(property.type), element);
    return at_;
  }

 private:
  /// Reads the count of the list that begins here, and returns the bytes of its items.
  std::uint64_t listBytes(const PlyProperty& property) {
    const std::size_t size = scalarBytes(*property.countType);
    std::byte value[8] = {};
    load(std::span(value).first(size));
    if (bigEndian_) std::reverse(value, value + size);
    const double count = loadScalar(value, *property.countType);
    if (!(count >= 0.0 && count < 4294967296.0)) throw Error(bytes_.name(), "found a list with a senseless count");
    at_ += size;
    return static_cast<std::uint64_t>(count) * scalarBytes(property.type);
  }

  void load(std::span<std::byte> out) {
    if (at_ < windowStart_ || at_ + out.size() > windowStart_ + window_.size()) {
      window_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kWindowBytes, bytes_.size() - at_)));
      if (window_.size() < out.size()) throw Error(bytes_.name(), "the file ends early, before its points");
      windowStart_ = at_;
      bytes_.read(windowStart_, window_);
    }
    const std::byte* from = window_.data() + (at_ - windowStart_);
    std::copy(from, from + out.size(), out.begin());
  }

  void advance(std::uint64_t count, const PlyElement& element) {
    if (count > bytes_.size() - at_)
      throw Error(bytes_.name(), "the file ends early, within element '" + element.name + "'");
    at_ += count;
  }

  const ByteSource& bytes_;
  std::uint64_t at_;
  bool bigEndian_;
  std::vector<std::byte> window_;
  std::uint64_t windowStart_ = 0;
};

bool isAxis(const std::string& name) {
  const std::string lower = lowerCase(name);
  return lower == "x" || lower == "y" || lower == "z";
}

std::unique_ptr<PointSource> openBinary(std::unique_ptr<ByteSource> bytes, const PlyHeader& header, bool skipDamaged) {
  const PlyElement& vertex = header.elements[header.vertex];
  const bool bigEndian = header.encoding == PlyEncoding::bigEndian;
  if (vertex.hasLists())
    throw Error(bytes->name(),
                "its points have list properties, which are read from ascii PLY only; save it without them");
  std::uint64_t offset = header.headerBytes;
  for (std::size_t i = 0; i < header.vertex; ++i) {
    const PlyElement& element = header.elements[i];
    if (element.hasLists()) {
      offset = ListWalker(*bytes, offset, bigEndian).skip(element);
    } else if (element.bytes() > 0) {
      if (element.count > (bytes->size() - offset) / element.bytes())
        throw Error(bytes->name(), "the file ends early, within element '" + element.name + "'");
      offset += element.count * element.bytes();
    }
  }
  RecordFile file;
  file.format = bigEndian ? "PLY binary big-endian" : "PLY binary";
  file.dataOffset = offset;
  file.pointCount = vertex.count;
  file.recordBytes = vertex.bytes();
  file.bigEndian = bigEndian;
  file.skipDamaged = skipDamaged;
  std::size_t at = 0;
  for (const PlyProperty& property : vertex.properties) {
    file.fields.push_back({property.name, property.type, 1, at});
    at += scalarBytes(property.type);
  }
  return openRecords(std::move(bytes), std::move(file));
}

std::unique_ptr<PointSource> openAscii(std::unique_ptr<ByteSource> bytes, const PlyHeader& header, bool skipDamaged) {
  TextTable table;
  table.format = "PLY ascii";
  table.skipDamaged = skipDamaged;
  table.begin = header.headerBytes;
  table.firstLine = header.headerLines + 1;
  for (std::size_t i = 0; i < header.vertex; ++i) {
    if (header.elements[i].properties.empty()) continue;
    const SkippedLines element = skipLines(*bytes, table.begin, header.elements[i].count, table.firstLine);
    table.begin = element.end;
    table.firstLine = element.nextLine;
  }
  const PlyElement& vertex = header.elements[header.vertex];
  table.claimedPoints = vertex.count;
  const SkippedLines body = skipLines(*bytes, table.begin, vertex.count, table.firstLine);
  table.end = body.end;
  if (body.points < vertex.count && !skipDamaged)
    throw Error(bytes->name(), "the file ends early, found " + std::to_string(body.points) + " points (expected " +
                                   std::to_string(vertex.count) + ")");
  for (const PlyProperty& property : vertex.properties) {
    if (property.countType) {
      table.columns.push_back({.kind = TextColumn::Kind::list});
      continue;
    }
    table.columns.push_back({.field = table.fields.size()});
    const bool decimal = isAxis(property.name) && property.type == ScalarType::f32;
    table.fields.push_back({.name = property.name, .type = decimal ? ScalarType::f64 : property.type});
  }
  packFields(table);
  TextSurvey survey = surveyText(*bytes, table);
  return openTextTable(std::move(bytes), std::move(table), std::move(survey));
}

}  // namespace

std::unique_ptr<PointSource> openPly(const std::string& path, const SourceOptions& options) {
  std::unique_ptr<ByteSource> bytes = openFile(path);
  const PlyHeader header = parsePlyHeader(path, readBeginning(*bytes, kHeadBytes));
  return header.encoding == PlyEncoding::ascii ? openAscii(std::move(bytes), header, options.skipDamaged)
                                               : openBinary(std::move(bytes), header, options.skipDamaged);
}

}  // namespace strata
