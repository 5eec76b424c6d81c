#include "io/table/ply_header.h"

#include <algorithm>
#include <array>

#include "core/error.h"
#include "core/text.h"
#include "io/table/header_lines.h"
#include "io/table/text_lines.h"

namespace strata {
namespace {

constexpr std::size_t kMostProperties = 65535;

struct TypeName {
  std::string_view name;
  ScalarType type;
};
constexpr std::array<TypeName, 20> kTypes{
    {{"char", ScalarType::i8},    {"int8", ScalarType::i8},     {"uchar", ScalarType::u8},
     {"uint8", ScalarType::u8},   {"bool", ScalarType::u8},     {"short", ScalarType::i16},
     {"int16", ScalarType::i16},  {"ushort", ScalarType::u16},  {"uint16", ScalarType::u16},
     {"int", ScalarType::i32},    {"int32", ScalarType::i32},   {"uint", ScalarType::u32},
     {"uint32", ScalarType::u32}, {"float", ScalarType::f32},   {"float32", ScalarType::f32},
     {"double", ScalarType::f64}, {"float64", ScalarType::f64}, {"int64", ScalarType::i64},
     {"uint64", ScalarType::u64}, {"long", ScalarType::i64}}};

/// Reads the header line by line, so that every error names its line.
class PlyHeaderParser {
 public:
  PlyHeaderParser(const std::string& file, std::string_view head) : file_(file), lines_(file, head) {}

  PlyHeader run() {
    if (!lines_.next() || words_.empty() || words_[0] != "ply") throw Error(file_, "found no 'ply' in line 1");
    bool formatSeen = false;
    while (lines_.next()) {
      if (words_.empty() || words_[0] == "comment" || words_[0] == "obj_info") continue;
      if (words_[0] == "end_header") {
        if (!formatSeen) lines_.fail("found no format line");
        return finish();
      }
      if (words_[0] == "format") {
        format();
        formatSeen = true;
      } else if (words_[0] == "element") {
        element();
      } else if (words_[0] == "property") {
        property();
      } else {
        lines_.fail("found '" + shownWord(words_[0]) + "' (expected element, property or end_header)");
      }
    }
    throw Error(file_, "the header ends early, found no end_header");
  }

 private:
  void format() {
    if (words_.size() < 2) lines_.fail("found a format line without a format");
    if (words_[1] == "ascii")
      header_.encoding = PlyEncoding::ascii;
    else if (words_[1] == "binary_little_endian")
      header_.encoding = PlyEncoding::littleEndian;
    else if (words_[1] == "binary_big_endian")
      header_.encoding = PlyEncoding::bigEndian;
    else
      lines_.fail("found format '" + shownWord(words_[1]) +
                  "' (expected ascii, binary_little_endian or binary_big_endian)");
    if (words_.size() > 2 && words_[2] != "1.0")
      lines_.fail("found version '" + shownWord(words_[2]) + "' (expected 1.0)");
  }

  void element() {
    if (words_.size() < 3) lines_.fail("found an element without name and count");
    PlyElement element;
    element.name = words_[1];
    if (!parseWhole(words_[2], element.count))
      lines_.fail("found '" + shownWord(words_[2]) + "' (expected the number of elements)");
    header_.elements.push_back(std::move(element));
  }

  ScalarType type(std::string_view name) const {
    for (const TypeName& known : kTypes)
      if (known.name == name) return known.type;
    lines_.fail("unknown type '" + shownWord(name) + "'");
  }

  void property() {
    if (header_.elements.empty()) lines_.fail("found a property before the first element");
    std::vector<PlyProperty>& properties = header_.elements.back().properties;
    if (properties.size() == kMostProperties)
      lines_.fail("found more than " + std::to_string(kMostProperties) + " properties");
    if (words_.size() >= 5 && words_[1] == "list") {
      const ScalarType count = type(words_[2]);
      if (count == ScalarType::f32 || count == ScalarType::f64)
        lines_.fail("found a list with a count that is no integer");
      properties.push_back({std::string(words_[4]), type(words_[3]), count});
    } else if (words_.size() >= 3 && words_[1] != "list") {
      properties.push_back({std::string(words_[2]), type(words_[1]), std::nullopt});
    } else {
      lines_.fail("found a property without type and name");
    }
  }

  PlyHeader finish() {
    const auto vertex = std::find_if(header_.elements.begin(), header_.elements.end(),
                                     [](const PlyElement& element) { return element.name == "vertex"; });
    if (vertex == header_.elements.end()) throw Error(file_, "found no element 'vertex', so it holds no points");
    header_.vertex = static_cast<std::size_t>(vertex - header_.elements.begin());
    header_.headerBytes = lines_.bytes();
    header_.headerLines = lines_.lines();
    return std::move(header_);
  }

  const std::string& file_;
  HeaderLines lines_;
  const std::vector<std::string_view>& words_ = lines_.words();
  PlyHeader header_;
};

}  // namespace

bool PlyElement::hasLists() const {
  return std::any_of(properties.begin(), properties.end(),
                     [](const PlyProperty& p) { return p.countType.has_value(); });
}

std::size_t PlyElement::bytes() const {
  std::size_t sum = 0;
  for (const PlyProperty& property : properties) sum += scalarBytes(property.type);
  return sum;
}

PlyHeader parsePlyHeader(const std::string& file, std::string_view head) { return PlyHeaderParser(file, head).run(); }

}  // namespace strata
