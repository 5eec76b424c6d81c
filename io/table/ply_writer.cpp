#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <set>
#include <span>

#include "core/error.h"
#include "core/octahedral.h"
#include "io/file/part_file.h"
#include "io/scan/scan_writer.h"

namespace strata {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{4} << 20;

std::string_view plyType(ScalarType type) {
  switch (type) {
    case ScalarType::u8:
      return "uchar";
    case ScalarType::i8:
      return "char";
    case ScalarType::u16:
      return "ushort";
    case ScalarType::i16:
      return "short";
    case ScalarType::u32:
      return "uint";
    case ScalarType::i32:
      return "int";
    case ScalarType::f32:
      return "float";
    case ScalarType::u64:
    case ScalarType::i64:
    case ScalarType::f64:
      break;
  }
  return "double";  // PLY has no 64-bit integers
}

/// A name of one word that no other property of the header has.
std::string propertyName(std::string name, std::set<std::string>& used) {
  for (char& c : name)
    if (!std::isgraph(static_cast<unsigned char>(c))) c = '_';
  if (name.empty()) name += '_';
  std::string unique = name;
  for (int n = 2; !used.insert(unique).second; ++n) {
    unique = name;
    unique.append("_").append(std::to_string(n));
  }
  return unique;
}

class PlyWriter final : public ScanWriter {
 public:
  PlyWriter(const std::string& path, const StoreInfo& info, std::uint64_t points)
      : path_(path), info_(info), expected_(points), file_(path) {
    rgb_ = info_.layout.find(attribute::kRgb);
    const std::string header = headerText();
    file_->append(std::as_bytes(std::span(header)));
    recordBytes_ = 3 * sizeof(double) + (rgb_ >= 0 ? 3 : 0);
    for (std::size_t i = 0; i < info_.layout.attributes().size(); ++i)
      if (isPlain(i)) recordBytes_ += writtenBytes(info_.layout.attributes()[i]);
  }

  void write(const NodePoints& points) override {
    const std::size_t stride = info_.layout.stride();
    for (std::size_t i = 0; i < points.count(); ++i) {
      const std::size_t at = buffer_.size();
      buffer_.resize(at + recordBytes_);
      pack(points, i, points.attributes.data() + i * stride, buffer_.data() + at);
      if (buffer_.size() >= kBufferBytes) flush();
    }
    written_ += points.count();
  }

  void finish() override {
    flush();
    if (written_ != expected_)
      throw Error(
          path_, "found " + std::to_string(written_) + " points to write (expected " + std::to_string(expected_) + ")");
    file_.keep();
  }

 private:
  std::string headerText() const {
    std::string text = "ply\nformat binary_little_endian 1.0\ncomment written by Strata\nelement vertex " +
                       std::to_string(expected_) + "\n";
    std::set<std::string> used;
    const auto property = [&](std::string_view type, const std::string& name) {
      text.append("property ").append(type).append(" ").append(propertyName(name, used)).append("\n");
    };
    for (const char* axis : {"x", "y", "z"}) property("double", axis);
    if (rgb_ >= 0)
      for (const char* channel : {"red", "green", "blue"}) property("uchar", channel);
    for (std::size_t i = 0; i < info_.layout.attributes().size(); ++i) {
      if (!isPlain(i)) continue;
      const Attribute& a = info_.layout.attributes()[i];
      const std::string name = a.name.starts_with("extra:") ? a.name.substr(6) : a.name;
      if (a.name == attribute::kNormal || isOctahedral(a))
        for (const char* axis : {"nx", "ny", "nz"}) property("float", axis);
      else if (a.components == 1)
        property(plyType(a.type), name);
      else
        for (int k = 0; k < a.components; ++k)
          property(plyType(a.type), std::string(name).append("_").append(std::to_string(k)));
    }
    return text + "end_header\n";
  }

  void pack(const NodePoints& points, std::size_t index, const std::byte* record, std::byte* out) const {
    for (int axis = 0; axis < 3; ++axis) {
      const double value =
          info_.grid.offset[axis] + info_.grid.scale[axis] * static_cast<double>(points.grid[axis][index]);
      std::memcpy(out, &value, sizeof value);
      out += sizeof value;
    }
    if (rgb_ >= 0) {
      const std::byte* from = record + info_.layout.offset(static_cast<std::size_t>(rgb_));
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint16_t channel = 0;
        std::memcpy(&channel, from + 2 * k, sizeof channel);
        *out++ = static_cast<std::byte>(channel >> colourShift(record) & 255);
      }
    }
    for (std::size_t i = 0; i < info_.layout.attributes().size(); ++i) {
      if (!isPlain(i)) continue;
      const Attribute& a = info_.layout.attributes()[i];
      copyValues(a, record + info_.layout.offset(i), out);
      out += writtenBytes(a);
    }
  }

  static bool isOctahedral(const Attribute& a) { return a.name == attribute::kNormalOctahedral && a.bytes() == 2; }
  static std::size_t writtenBytes(const Attribute& a) { return isOctahedral(a) ? sizeof(glm::vec3) : a.bytes(); }

  /// False for colours, which are written apart, and for attributes that Strata made for itself, which are not written.
  bool isPlain(std::size_t i) const {
    return static_cast<int>(i) != rgb_ && !info_.layout.attributes()[i].isInternal();
  }

  int colourShift(const std::byte* record) const {
    const int own = info_.layout.find(attribute::kColourShift);
    return own < 0 ? info_.colourShift : static_cast<int>(record[info_.layout.offset(static_cast<std::size_t>(own))]);
  }

  static void copyValues(const Attribute& a, const std::byte* from, std::byte* to) {
    if (isOctahedral(a)) {
      const glm::vec3 normal =
          decodeOctahedral({static_cast<std::uint8_t>(from[0]), static_cast<std::uint8_t>(from[1])});
      std::memcpy(to, &normal, sizeof normal);
      return;
    }
    if (a.type != ScalarType::u64 && a.type != ScalarType::i64) {
      std::memcpy(to, from, a.bytes());
      return;
    }
    for (std::size_t k = 0; k < a.components; ++k) {
      std::int64_t value = 0;
      std::memcpy(&value, from + 8 * k, sizeof value);
      const double written = a.type == ScalarType::u64 ? static_cast<double>(static_cast<std::uint64_t>(value))
                                                       : static_cast<double>(value);
      std::memcpy(to + 8 * k, &written, sizeof written);
    }
  }

  void flush() {
    file_->append(buffer_);
    buffer_.clear();
  }

  std::string path_;
  StoreInfo info_;
  std::uint64_t expected_;
  PartFile file_;
  int rgb_ = -1;
  std::size_t recordBytes_ = 0;
  std::vector<std::byte> buffer_;
  std::uint64_t written_ = 0;
};

}  // namespace

std::unique_ptr<ScanWriter> createPlyWriter(const std::string& path, const StoreInfo& info, std::uint64_t points) {
  return std::make_unique<PlyWriter>(path, info, points);
}

}  // namespace strata
