#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/file/byte_source.h"
#include "io/scan/point_source.h"

namespace strata {

/// The public header block of a LAS or LAZ file (LAS 1.4 R15, table 3). Its fields are checked, except for `bounds` and
/// the counts of points and VLRs, which are claims of the file.
struct LasHeader {
  std::uint8_t versionMinor = 2;
  std::uint16_t fileSourceId = 0;
  std::uint16_t globalEncoding = 0;
  std::string systemIdentifier;
  std::string generatingSoftware;
  std::uint16_t creationDay = 0;
  std::uint16_t creationYear = 0;
  std::uint16_t headerBytes = 0;
  std::uint32_t pointsOffset = 0;      ///< first byte of point data
  std::uint32_t vlrCount = 0;          ///< as claimed
  std::uint8_t pointFormat = 0;        ///< 0 to 10
  bool compressed = false;             ///< LAZ: bit 7 of the format byte
  std::uint16_t recordBytes = 0;       ///< at least lasFormatBytes(pointFormat)
  std::uint32_t legacyPointCount = 0;  ///< the 32-bit field
  std::uint64_t pointCount = 0;        ///< the 64-bit field of 1.4 where it is not 0, else the 32-bit one
  glm::dvec3 scale{0.0};               ///< finite, not 0
  glm::dvec3 offset{0.0};              ///< finite
  Box bounds;                          ///< empty when not finite or not min <= max
  std::uint64_t evlrStart = 0;
  std::uint32_t evlrCount = 0;
};

inline constexpr std::size_t kLasLargestHeader = 375;  ///< bytes of a version 1.4 header
inline constexpr int kLasLastFormat = 10;

/// Bytes of a record of this point format without extra bytes.
std::uint16_t lasFormatBytes(int pointFormat);

/// The text of a field up to its first NUL. Bytes that are not UTF-8 become '?', so that the text can be put into JSON.
std::string lasText(std::string_view field);

/// Decodes the header at the start of `bytes`. `file` is the name for errors, and `fileBytes` the size of the whole
/// file. Throws Error for anything that cannot be read as LAS 1.0 to 1.4.
LasHeader parseLasHeader(const std::string& file, std::span<const std::byte> bytes, std::uint64_t fileBytes);

/// Decodes the VLRs between header and points. `head` is the file from byte 0 to the first point. Some real files have
/// fewer VLRs than their header counts; the result then holds those that are complete.
std::vector<LasMeta::Vlr> parseVlrs(std::span<const std::byte> head, const LasHeader& header);

/// The header and all VLRs of a file, including those behind the points (EVLRs). One of more than kLargestVlr bytes,
/// which holds waveform samples, is left out.
struct LasHead {
  LasHeader header;
  std::vector<LasMeta::Vlr> vlrs;
};
inline constexpr std::uint64_t kLargestVlr = std::uint64_t{64} << 20;
/// Reads the head of a file. Throws as parseLasHeader() and ByteSource::read().
LasHead readLasHead(const ByteSource& file);

/// The fields of a header that depend on the points.
struct LasTotals {
  std::uint64_t points = 0;
  std::array<std::uint64_t, 16> byReturn{};  ///< [n]: points of return number n; [0] is not written
  Box bounds;
  std::uint64_t evlrStart = 0;
};

/// The inverse of readLasHead(): the bytes of header and VLRs that come before the points. VLRs of more than 65535
/// bytes are left to encodeEvlrs(). `compressed` sets bit 7 of the format. Throws Error naming `file` when the points
/// need more than 32 bits to count before version 1.4, or the VLRs have more bytes than 32 bits count.
std::vector<std::byte> encodeLasHead(const std::string& file, const LasMeta& meta,
                                     const std::vector<LasMeta::Vlr>& vlrs, bool compressed, const LasTotals& totals);
/// The bytes of the VLRs that are too large to come before the points, for the end of the file; empty when there are
/// none. Only version 1.4 has a place for them.
std::vector<std::byte> encodeEvlrs(const std::vector<LasMeta::Vlr>& vlrs);

}  // namespace strata
