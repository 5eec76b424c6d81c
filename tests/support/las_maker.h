#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace strata::test {

/// Bytes of a point record of each LAS point data format, without extra bytes (LAS 1.4 R15, tables 7 to 23).
inline constexpr std::array<std::uint16_t, 11> kLasRecordBytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

/// A LAS file to be made. It is correct by default, and every optional field makes it lie in one way.
struct LasSpec {
  using Triple = std::array<double, 3>;

  int versionMinor = 2;  ///< 2 for formats 0 to 3, 4 for 6 to 8
  int format = 0;
  Triple scale{0.01, 0.01, 0.01};
  Triple offset{0.0, 0.0, 0.0};
  std::vector<std::array<std::int32_t, 3>> points;  ///< the integers that the records store
  std::optional<std::uint64_t> claimedPoints;
  std::optional<Triple> claimedMin, claimedMax;
  std::optional<std::uint32_t> claimedDataOffset;
  std::optional<std::uint16_t> claimedRecordBytes;
  std::optional<std::uint64_t> keepBytes;  ///< the file is cut off behind so many bytes
};

namespace detail {
template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}
template <class T>
T get(const std::string& bytes, std::size_t at) {
  if (at + sizeof(T) > bytes.size()) throw std::runtime_error("LAS file too short");
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}
}  // namespace detail

/// Makes the file. The intensities of the records count up, so that no two of at most 65536 records are equal.
inline std::string lasBytes(const LasSpec& spec) {
  using detail::put;
  const std::uint16_t headerBytes = spec.versionMinor >= 4 ? 375 : spec.versionMinor == 3 ? 235 : 227;
  const std::uint16_t recordBytes = kLasRecordBytes.at(static_cast<std::size_t>(spec.format));
  const std::uint64_t count = spec.claimedPoints.value_or(spec.points.size());
  std::string bytes(headerBytes + spec.points.size() * recordBytes, '\0');
  bytes.replace(0, 4, "LASF");
  put(bytes, 24, std::uint8_t{1});
  put(bytes, 25, static_cast<std::uint8_t>(spec.versionMinor));
  bytes.replace(26, 11, "Strata test");
  bytes.replace(58, 11, "Strata test");
  put(bytes, 90, std::uint16_t{1});
  put(bytes, 92, std::uint16_t{2024});
  put(bytes, 94, headerBytes);
  put(bytes, 96, spec.claimedDataOffset.value_or(headerBytes));
  put(bytes, 104, static_cast<std::uint8_t>(spec.format));
  put(bytes, 105, spec.claimedRecordBytes.value_or(recordBytes));
  if (spec.format < 6) {
    put(bytes, 107, static_cast<std::uint32_t>(count));
    put(bytes, 111, static_cast<std::uint32_t>(count));
  }
  if (spec.versionMinor >= 4) {
    put(bytes, 247, count);
    put(bytes, 255, count);
    if (spec.format >= 6) put(bytes, 6, std::uint16_t{16});  // global encoding: WKT
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put(bytes, 131 + 8 * axis, spec.scale[axis]);
    put(bytes, 155 + 8 * axis, spec.offset[axis]);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& point : spec.points) {
      const double value = spec.offset[axis] + spec.scale[axis] * point[axis];
      low = std::min(low, value);
      high = std::max(high, value);
    }
    put(bytes, 179 + 16 * axis, spec.claimedMax ? (*spec.claimedMax)[axis] : high);
    put(bytes, 187 + 16 * axis, spec.claimedMin ? (*spec.claimedMin)[axis] : low);
  }
  for (std::size_t i = 0; i < spec.points.size(); ++i) {
    const std::size_t record = headerBytes + i * recordBytes;
    for (std::size_t axis = 0; axis < 3; ++axis) put(bytes, record + 4 * axis, spec.points[i][axis]);
    put(bytes, record + 12, static_cast<std::uint16_t>(i));
    put(bytes, record + 14, static_cast<std::uint8_t>(spec.format < 6 ? 0x09 : 0x11));  // return 1 of 1
  }
  if (spec.keepBytes) bytes.resize(std::min<std::uint64_t>(*spec.keepBytes, bytes.size()));
  return bytes;
}

inline void writeBytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!out) throw std::runtime_error("cannot write " + path.string());
}

inline void writeLas(const std::filesystem::path& path, const LasSpec& spec) { writeBytes(path, lasBytes(spec)); }

/// An uncompressed LAS file that was read without the code under test.
struct LasFile {
  int format = 0;
  std::uint16_t recordBytes = 0;
  std::uint64_t count = 0;
  std::array<double, 3> scale{}, offset{};
  std::string records;  ///< count * recordBytes

  std::string_view record(std::uint64_t index) const {
    return std::string_view(records).substr(index * recordBytes, recordBytes);
  }
  std::array<double, 3> position(std::uint64_t index) const {
    std::array<double, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      at[axis] = offset[axis] + scale[axis] * detail::get<std::int32_t>(records, index * recordBytes + 4 * axis);
    return at;
  }
  std::vector<std::string_view> sortedRecords() const {
    std::vector<std::string_view> sorted;
    sorted.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i) sorted.push_back(record(i));
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }
};

inline LasFile readLas(const std::filesystem::path& path) {
  using detail::get;
  std::ifstream in(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  LasFile las;
  if (bytes.rfind("LASF", 0) != 0) throw std::runtime_error(path.string() + " is no LAS file");
  las.format = get<std::uint8_t>(bytes, 104);
  if (las.format & 0x80) throw std::runtime_error(path.string() + " is compressed");
  las.recordBytes = get<std::uint16_t>(bytes, 105);
  las.count = get<std::uint32_t>(bytes, 107);
  if (get<std::uint8_t>(bytes, 25) >= 4) las.count = get<std::uint64_t>(bytes, 247);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    las.scale[axis] = get<double>(bytes, 131 + 8 * axis);
    las.offset[axis] = get<double>(bytes, 155 + 8 * axis);
  }
  const std::uint32_t dataOffset = get<std::uint32_t>(bytes, 96);
  if (dataOffset + las.count * las.recordBytes > bytes.size()) throw std::runtime_error(path.string() + " is cut off");
  las.records = bytes.substr(dataOffset, las.count * las.recordBytes);
  return las;
}

}  // namespace strata::test
