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

/// The public header block of a LAS or LAZ file (LAS 1.4 R15, table 3), checked: what stands here can be relied on,
/// but for `bounds` and the two counts, which are claims.
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

inline constexpr std::size_t kLasLargestHeader = 375;  ///< bytes, of version 1.4
inline constexpr int kLasLastFormat = 10;

/// Bytes of a record of this point format without extra bytes.
std::uint16_t lasFormatBytes(int pointFormat);

/// A text field up to its first NUL; bytes that are not UTF-8 become '?', so that the text may stand in JSON.
std::string lasText(std::string_view field);

/// Decodes the header at the start of `bytes`. `file` names it in errors; `fileBytes` is the whole file's size.
/// Throws Error for anything that cannot be read as LAS 1.0 to 1.4.
LasHeader parseLasHeader(const std::string& file, std::span<const std::byte> bytes, std::uint64_t fileBytes);

/// The records between header and points. `head` starts at byte 0 of the file and ends where points start. A count
/// that is too large is cut to the records that are whole: real files have that.
std::vector<LasMeta::Vlr> parseVlrs(std::span<const std::byte> head, const LasHeader& header);

/// The header and all records of a file, those behind the points (EVLRs) included. A record of more than
/// kLargestVlr bytes (waveform samples) is left out.
struct LasHead {
  LasHeader header;
  std::vector<LasMeta::Vlr> vlrs;
};
inline constexpr std::uint64_t kLargestVlr = std::uint64_t{64} << 20;
LasHead readLasHead(const ByteSource& file);

/// What the writer has to know beyond LasMeta.
struct LasTotals {
  std::uint64_t points = 0;
  std::array<std::uint64_t, 16> byReturn{};  ///< [n]: points of return number n; [0] is not written
  Box bounds;
  std::uint64_t evlrStart = 0;
};

/// Header and VLRs as bytes, ready to stand before the points (the inverse of readLasHead). Records of more than
/// 65535 bytes are left for encodeEvlrs. `compressed` sets bit 7 of the format. Throws Error, naming `file`, when
/// LAS cannot state it: more points than 32 bits before version 1.4, more VLR bytes than 32 bits.
std::vector<std::byte> encodeLasHead(const std::string& file, const LasMeta& meta,
                                     const std::vector<LasMeta::Vlr>& vlrs, bool compressed, const LasTotals& totals);
/// The records too large for a VLR; empty where there are none. Only version 1.4 has a place for them.
std::vector<std::byte> encodeEvlrs(const std::vector<LasMeta::Vlr>& vlrs);

}  // namespace strata
