#include "io/table/pcd_header.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/text.h"
#include "io/table/header_lines.h"
#include "io/table/text_lines.h"

namespace strata {
namespace {

constexpr std::size_t kMostFields = 4096;
constexpr std::uint64_t kMostRecordBytes = 1 << 20;

class PcdHeaderParser {
 public:
  PcdHeaderParser(const std::string& file, std::string_view head) : file_(file), lines_(file, head) {}

  PcdHeader run() {
    bool anything = false;
    while (lines_.next()) {
      if (words_.empty() || words_[0].starts_with('#')) continue;
      const std::string_view key = words_[0];
      const std::vector<std::string_view> values(words_.begin() + 1, words_.end());
      if (key == "FIELDS" || key == "COLUMNS") {
        names_ = values;
      } else if (key == "SIZE") {
        sizes_ = numbers(values);
      } else if (key == "TYPE") {
        types_ = values;
      } else if (key == "COUNT") {
        counts_ = numbers(values);
      } else if (key == "WIDTH" || key == "HEIGHT" || key == "POINTS") {
        if (values.size() != 1) lines_.fail("found " + std::to_string(values.size()) + " numbers (expected 1)");
        (key == "WIDTH" ? width_ : key == "HEIGHT" ? height_ : points_) = numbers(values)[0];
        pointsSeen_ = pointsSeen_ || key == "POINTS";
      } else if (key == "DATA") {
        if (values.empty()) lines_.fail("found DATA without ascii, binary or binary_compressed");
        return finish(values[0]);
      } else if (key == "VIEWPOINT") {
        readViewpoint(values);
      } else if (key != "VERSION") {
        lines_.fail("found '" + shownWord(key) + "' (expected a keyword of the PCD header)" +
                    (anything ? "" : ": this is no PCD file"));
      }
      anything = true;
    }
    throw Error(file_, "the header ends early, found no DATA line");
  }

 private:
  std::vector<std::uint64_t> numbers(const std::vector<std::string_view>& words) const {
    std::vector<std::uint64_t> values;
    for (const std::string_view word : words) {
      std::uint64_t value = 0;
      if (!parseWhole(word, value)) lines_.fail("found '" + shownWord(word) + "' (expected a number)");
      values.push_back(value);
    }
    return values;
  }

  /// Takes three coordinates; a quaternion follows them. Errors in it are ignored, since they harm no point.
  void readViewpoint(const std::vector<std::string_view>& words) {
    glm::dvec3 at(0.0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (axis >= words.size()) return;
      const std::string_view word = words[axis];
      double& value = at[static_cast<int>(axis)];
      if (!parseWhole(word, value) || !std::isfinite(value)) return;
    }
    if (at != glm::dvec3(0.0)) header_.viewpoint = at;
  }

  ScalarType type(std::string_view letter, std::uint64_t size) const {
    if (letter == "F" && size == 4) return ScalarType::f32;
    if (letter == "F" && size == 8) return ScalarType::f64;
    if (letter == "U" || letter == "I") {
      const bool isSigned = letter == "I";
      if (size == 1) return isSigned ? ScalarType::i8 : ScalarType::u8;
      if (size == 2) return isSigned ? ScalarType::i16 : ScalarType::u16;
      if (size == 4) return isSigned ? ScalarType::i32 : ScalarType::u32;
      if (size == 8) return isSigned ? ScalarType::i64 : ScalarType::u64;
    }
    throw Error(file_, "found a field of TYPE " + shownWord(letter) + " and SIZE " + std::to_string(size) +
                           " (expected I, U or F of 1, 2, 4 or 8 bytes)");
  }

  void checkLists() {
    if (names_.empty()) throw Error(file_, "found no FIELDS");
    if (names_.size() > kMostFields)
      throw Error(file_, "found " + std::to_string(names_.size()) + " fields (expected at most " +
                             std::to_string(kMostFields) + ")");
    if (counts_.empty()) counts_.assign(names_.size(), 1);
    const auto check = [&](const char* key, std::size_t found) {
      if (found != names_.size())
        throw Error(file_, std::string(key) + ": found " + std::to_string(found) + " values (expected " +
                               std::to_string(names_.size()) + ", one a field)");
    };
    check("SIZE", sizes_.size());
    check("TYPE", types_.size());
    check("COUNT", counts_.size());
  }

  PcdHeader finish(std::string_view encoding) {
    if (encoding == "ascii")
      header_.encoding = PcdEncoding::ascii;
    else if (encoding == "binary")
      header_.encoding = PcdEncoding::binary;
    else if (encoding == "binary_compressed")
      header_.encoding = PcdEncoding::binaryCompressed;
    else
      lines_.fail("found DATA '" + shownWord(encoding) + "' (expected ascii, binary or binary_compressed)");
    checkLists();
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const ScalarType scalar = type(types_[i], sizes_[i]);
      if (counts_[i] == 0 || counts_[i] > kMostRecordBytes ||
          header_.recordBytes + counts_[i] * sizes_[i] > kMostRecordBytes)
        throw Error(file_, "field '" + shownWord(names_[i]) + "': found COUNT " + std::to_string(counts_[i]) +
                               " (expected 1 or more, and points of at most a megabyte)");
      header_.fields.push_back(
          {std::string(names_[i]), scalar, static_cast<std::uint32_t>(counts_[i]), header_.recordBytes});
      header_.recordBytes += header_.fields.back().bytes();
    }
    if (height_ != 0 && width_ > std::numeric_limits<std::uint64_t>::max() / height_)
      throw Error(file_, "found a WIDTH and HEIGHT that no file can hold");
    header_.points = pointsSeen_ ? points_ : width_ * height_;
    if (pointsSeen_ && width_ != 0 && width_ * height_ != points_)
      throw Error(file_, "found " + std::to_string(points_) + " POINTS (expected " + std::to_string(width_ * height_) +
                             ", WIDTH times HEIGHT)");
    header_.headerBytes = lines_.bytes();
    header_.headerLines = lines_.lines();
    return std::move(header_);
  }

  const std::string& file_;
  HeaderLines lines_;
  const std::vector<std::string_view>& words_ = lines_.words();
  PcdHeader header_;
  std::vector<std::string_view> names_;
  std::vector<std::string_view> types_;
  std::vector<std::uint64_t> sizes_;
  std::vector<std::uint64_t> counts_;
  std::uint64_t width_ = 0;
  std::uint64_t height_ = 1;
  std::uint64_t points_ = 0;
  bool pointsSeen_ = false;
};

}  // namespace

PcdHeader parsePcdHeader(const std::string& file, std::string_view head) { return PcdHeaderParser(file, head).run(); }

}  // namespace strata
