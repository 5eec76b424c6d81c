#include "io/las/las_header.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.h"

namespace strata {
namespace {

constexpr std::size_t kVlrHeader = 54;
constexpr std::size_t kEvlrHeader = 60;
constexpr std::size_t kHeaderBytes[5] = {227, 227, 227, 235, 375};  // by versionMinor
constexpr std::size_t kLargestVlrPayload = 65535;
constexpr std::uint16_t kFormatBytes[kLasLastFormat + 1] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr std::uint8_t kCompressedBit = 0x80;

/// Loads a little-endian field; the caller has checked that it lies inside `bytes`.
template <typename T>
T load(std::span<const std::byte> bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

template <typename T>
void store(std::vector<std::byte>& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

std::string loadText(std::span<const std::byte> bytes, std::size_t at, std::size_t size) {
  const auto* text = reinterpret_cast<const char*>(bytes.data() + at);
  return lasText({text, size});
}

void storeText(std::vector<std::byte>& bytes, std::size_t at, std::size_t size, const std::string& text) {
  std::memcpy(bytes.data() + at, text.data(), std::min(size, text.size()));
}

/// The length of the UTF-8 character at the start of `text`; 0 when there is none.
std::size_t characterBytes(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t size = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < size) return 0;
  std::uint32_t code = lead & (0x7fu >> size);
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3f);
  }
  constexpr std::uint32_t kSmallest[5] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  return code < kSmallest[size] || code > 0x10ffff || surrogate ? 0 : size;
}

std::string versionText(unsigned major, unsigned minor) { return std::to_string(major) + "." + std::to_string(minor); }

/// Checks signature, version, sizes and offsets, on which the place of every other field depends.
void checkSizes(const std::string& file, std::span<const std::byte> bytes, std::uint64_t fileBytes) {
  if (fileBytes == 0) throw Error(file, "the file is empty, found 0 bytes (expected a LAS or LAZ file)");
  if (bytes.size() < 4 || std::memcmp(bytes.data(), "LASF", 4) != 0)
    throw Error(file, "not a LAS or LAZ file, found no signature (expected LASF)");
  if (bytes.size() < kHeaderBytes[0])
    throw Error(file, "the file ends inside the header, found " + std::to_string(bytes.size()) +
                          " bytes (expected at least " + std::to_string(kHeaderBytes[0]) + ")");
  const auto major = load<std::uint8_t>(bytes, 24);
  const auto minor = load<std::uint8_t>(bytes, 25);
  if (major != 1 || minor > 4)
    throw Error(file, "unknown LAS version, found " + versionText(major, minor) + " (expected 1.0 to 1.4)");
  // Some writers of version 1.3 leave out the one field that it adds; version 1.4 cannot be read without its counts.
  const std::size_t needed = minor == 4 ? kHeaderBytes[4] : kHeaderBytes[0];
  const auto headerBytes = load<std::uint16_t>(bytes, 94);
  if (headerBytes < needed)
    throw Error(file, "the header is too short, found " + std::to_string(headerBytes) + " bytes (expected at least " +
                          std::to_string(needed) + ")");
  if (bytes.size() < needed)
    throw Error(file, "the file ends inside the header, found " + std::to_string(bytes.size()) +
                          " bytes (expected at least " + std::to_string(needed) + ")");
  const auto pointsOffset = load<std::uint32_t>(bytes, 96);
  if (pointsOffset < headerBytes)
    throw Error(file, "points start inside the header, found offset " + std::to_string(pointsOffset) +
                          " (expected at least " + std::to_string(headerBytes) + ")");
  if (pointsOffset > fileBytes)
    throw Error(file, "points start behind the end of the file, found offset " + std::to_string(pointsOffset) +
                          " (expected at most " + std::to_string(fileBytes) + ")");
}

void readFormat(const std::string& file, std::span<const std::byte> bytes, LasHeader& header) {
  const auto formatByte = load<std::uint8_t>(bytes, 104);
  header.compressed = (formatByte & kCompressedBit) != 0;
  header.pointFormat = formatByte & 0x7f;
  if (header.pointFormat > kLasLastFormat)
    throw Error(file, "unknown point format, found " + std::to_string(header.pointFormat) + " (expected 0 to 10)");
  header.recordBytes = load<std::uint16_t>(bytes, 105);
  const std::uint16_t needed = lasFormatBytes(header.pointFormat);
  if (header.recordBytes < needed)
    throw Error(file, "the point record is too short, found " + std::to_string(header.recordBytes) +
                          " bytes (expected at least " + std::to_string(needed) + " for format " +
                          std::to_string(header.pointFormat) + ")");
}

void readGrid(const std::string& file, std::span<const std::byte> bytes, LasHeader& header) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis) * 8;
    header.scale[axis] = load<double>(bytes, 131 + at);
    header.offset[axis] = load<double>(bytes, 155 + at);
    header.bounds.max[axis] = load<double>(bytes, 179 + 2 * at);
    header.bounds.min[axis] = load<double>(bytes, 187 + 2 * at);
    if (!std::isfinite(header.scale[axis]) || header.scale[axis] == 0.0)
      throw Error(file, "unusable scale factor, found " + std::to_string(header.scale[axis]) +
                            " (expected a finite number other than 0)");
    if (!std::isfinite(header.offset[axis]))
      throw Error(file,
                  "unusable offset, found " + std::to_string(header.offset[axis]) + " (expected a finite number)");
  }
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(header.bounds.min[axis]) || !std::isfinite(header.bounds.max[axis])) header.bounds = Box();
  if (header.bounds.empty()) header.bounds = Box();
}

/// Reads the EVLRs of version 1.4 one at a time, since they may lie anywhere behind the points.
void readEvlrs(const ByteSource& file, LasHead& head) {
  std::uint64_t at = head.header.evlrStart;
  for (std::uint32_t i = 0; i < head.header.evlrCount; ++i) {
    if (at < head.header.pointsOffset || at > file.size() || file.size() - at < kEvlrHeader) return;
    std::byte fields[kEvlrHeader];
    file.read(at, fields);
    const std::span<const std::byte> view(fields);
    const auto size = load<std::uint64_t>(view, 20);
    at += kEvlrHeader;
    if (size > file.size() - at) return;
    if (size <= kLargestVlr) {
      LasMeta::Vlr vlr{loadText(view, 2, 16), load<std::uint16_t>(view, 18), loadText(view, 28, 32),
                       std::vector<std::uint8_t>(static_cast<std::size_t>(size))};
      file.read(at, std::as_writable_bytes(std::span(vlr.data)));
      head.vlrs.push_back(std::move(vlr));
    }
    at += size;
  }
}

void appendData(std::vector<std::byte>& bytes, const LasMeta::Vlr& vlr) {
  const auto at = static_cast<std::ptrdiff_t>(bytes.size());
  bytes.resize(bytes.size() + vlr.data.size());
  std::ranges::copy(std::as_bytes(std::span(vlr.data)), bytes.begin() + at);
}

void appendVlr(std::vector<std::byte>& bytes, const LasMeta::Vlr& vlr) {
  const std::size_t at = bytes.size();
  bytes.resize(at + kVlrHeader);
  storeText(bytes, at + 2, 16, vlr.userId);
  store<std::uint16_t>(bytes, at + 18, vlr.recordId);
  store<std::uint16_t>(bytes, at + 20, static_cast<std::uint16_t>(vlr.data.size()));
  storeText(bytes, at + 22, 32, vlr.description);
  appendData(bytes, vlr);
}

}  // namespace

std::string lasText(std::string_view field) {
  std::string text(field.substr(0, field.find('\0')));
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t size = characterBytes(std::string_view(text).substr(i));
    if (size == 0) text[i] = '?';
    i += std::max<std::size_t>(size, 1);
  }
  return text;
}

std::uint16_t lasFormatBytes(int pointFormat) { return kFormatBytes[pointFormat]; }

LasHeader parseLasHeader(const std::string& file, std::span<const std::byte> bytes, std::uint64_t fileBytes) {
  checkSizes(file, bytes, fileBytes);
  LasHeader header;
  header.versionMinor = load<std::uint8_t>(bytes, 25);
  header.fileSourceId = load<std::uint16_t>(bytes, 4);
  header.globalEncoding = load<std::uint16_t>(bytes, 6);
  header.systemIdentifier = loadText(bytes, 26, 32);
  header.generatingSoftware = loadText(bytes, 58, 32);
  header.creationDay = load<std::uint16_t>(bytes, 90);
  header.creationYear = load<std::uint16_t>(bytes, 92);
  header.headerBytes = load<std::uint16_t>(bytes, 94);
  header.pointsOffset = load<std::uint32_t>(bytes, 96);
  header.vlrCount = load<std::uint32_t>(bytes, 100);
  readFormat(file, bytes, header);
  header.legacyPointCount = load<std::uint32_t>(bytes, 107);
  header.pointCount = header.legacyPointCount;
  readGrid(file, bytes, header);
  if (header.versionMinor >= 4) {
    header.evlrStart = load<std::uint64_t>(bytes, 235);
    header.evlrCount = load<std::uint32_t>(bytes, 243);
    const auto count = load<std::uint64_t>(bytes, 247);
    if (count != 0) header.pointCount = count;
  }
  return header;
}

std::vector<LasMeta::Vlr> parseVlrs(std::span<const std::byte> head, const LasHeader& header) {
  std::vector<LasMeta::Vlr> vlrs;
  std::size_t at = header.headerBytes;
  for (std::uint32_t i = 0; i < header.vlrCount; ++i) {
    if (at > head.size() || head.size() - at < kVlrHeader) break;
    const auto size = load<std::uint16_t>(head, at + 20);
    if (head.size() - at - kVlrHeader < size) break;
    const auto* data = reinterpret_cast<const std::uint8_t*>(head.data() + at + kVlrHeader);
    vlrs.push_back({loadText(head, at + 2, 16), load<std::uint16_t>(head, at + 18), loadText(head, at + 22, 32),
                    std::vector<std::uint8_t>(data, data + size)});
    at += kVlrHeader + size;
  }
  return vlrs;
}

LasHead readLasHead(const ByteSource& file) {
  std::vector<std::byte> bytes(static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), kLasLargestHeader)));
  file.read(0, bytes);
  LasHead head;
  head.header = parseLasHeader(file.name(), bytes, file.size());
  bytes.resize(static_cast<std::size_t>(std::min<std::uint64_t>(head.header.pointsOffset, kLargestVlr)));
  file.read(0, bytes);
  head.vlrs = parseVlrs(bytes, head.header);
  readEvlrs(file, head);
  return head;
}

std::vector<std::byte> encodeLasHead(const std::string& file, const LasMeta& meta,
                                     const std::vector<LasMeta::Vlr>& vlrs, bool compressed, const LasTotals& totals) {
  const bool wide = meta.versionMinor >= 4;
  if (!wide && totals.points > std::numeric_limits<std::uint32_t>::max())
    throw Error(file, "too many points for LAS " + versionText(1, meta.versionMinor) + ", found " +
                          std::to_string(totals.points) + " (expected at most 4294967295)");
  const std::size_t headerBytes = kHeaderBytes[meta.versionMinor];
  std::vector<std::byte> bytes(headerBytes);
  storeText(bytes, 0, 4, "LASF");
  store<std::uint16_t>(bytes, 4, meta.fileSourceId);
  store<std::uint16_t>(bytes, 6, meta.globalEncoding);
  store<std::uint8_t>(bytes, 24, 1);
  store<std::uint8_t>(bytes, 25, meta.versionMinor);
  storeText(bytes, 26, 32, meta.systemIdentifier);
  storeText(bytes, 58, 32, meta.generatingSoftware);
  store<std::uint16_t>(bytes, 90, meta.creationDay);
  store<std::uint16_t>(bytes, 92, meta.creationYear);
  store<std::uint16_t>(bytes, 94, static_cast<std::uint16_t>(headerBytes));
  store<std::uint8_t>(bytes, 104, static_cast<std::uint8_t>(meta.pointFormat | (compressed ? kCompressedBit : 0)));
  store<std::uint16_t>(bytes, 105, meta.recordBytes);

  // The 32-bit counts are 0 when they cannot hold the true ones (LAS 1.4 R15, "legacy" fields).
  const bool legacy = meta.pointFormat < 6 && totals.points <= std::numeric_limits<std::uint32_t>::max();
  store<std::uint32_t>(bytes, 107, legacy ? static_cast<std::uint32_t>(totals.points) : 0);
  for (std::size_t n = 1; n <= 5; ++n)
    store<std::uint32_t>(bytes, 107 + 4 * n, legacy ? static_cast<std::uint32_t>(totals.byReturn[n]) : 0);
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis) * 8;
    store<double>(bytes, 131 + at, meta.scale[axis]);
    store<double>(bytes, 155 + at, meta.offset[axis]);
    store<double>(bytes, 179 + 2 * at, totals.bounds.empty() ? 0.0 : totals.bounds.max[axis]);
    store<double>(bytes, 187 + 2 * at, totals.bounds.empty() ? 0.0 : totals.bounds.min[axis]);
  }

  std::uint32_t vlrCount = 0, evlrCount = 0;
  for (const LasMeta::Vlr& vlr : vlrs) {
    const bool extended = vlr.data.size() > kLargestVlrPayload;
    if (!extended) appendVlr(bytes, vlr);
    ++(extended ? evlrCount : vlrCount);
  }
  if (wide) {
    store<std::uint64_t>(bytes, 235, evlrCount != 0 ? totals.evlrStart : 0);
    store<std::uint32_t>(bytes, 243, evlrCount);
    store<std::uint64_t>(bytes, 247, totals.points);
    for (std::size_t n = 1; n <= 15; ++n) store<std::uint64_t>(bytes, 247 + 8 * n, totals.byReturn[n]);
  }
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max())
    throw Error(file, "too many records before the points, found " + std::to_string(bytes.size()) +
                          " bytes (expected less than 4 GiB)");
  store<std::uint32_t>(bytes, 96, static_cast<std::uint32_t>(bytes.size()));
  store<std::uint32_t>(bytes, 100, vlrCount);
  return bytes;
}

std::vector<std::byte> encodeEvlrs(const std::vector<LasMeta::Vlr>& vlrs) {
  std::vector<std::byte> bytes;
  for (const LasMeta::Vlr& vlr : vlrs) {
    if (vlr.data.size() <= kLargestVlrPayload) continue;
    const std::size_t at = bytes.size();
    bytes.resize(at + kEvlrHeader);
    storeText(bytes, at + 2, 16, vlr.userId);
    store<std::uint16_t>(bytes, at + 18, vlr.recordId);
    store<std::uint64_t>(bytes, at + 20, vlr.data.size());
    storeText(bytes, at + 28, 32, vlr.description);
    appendData(bytes, vlr);
  }
  return bytes;
}

}  // namespace strata
