#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/file/byte_source.h"
#include "io/las/las_header.h"

namespace strata {

/// What the LASzip record says of how points are compressed; checked against the header, so that the LASzip library
/// can be trusted with it.
struct LazFormat {
  static constexpr std::uint16_t kPointwise = 1;  ///< one stream without chunks
  static constexpr std::uint16_t kChunked = 2;
  static constexpr std::uint16_t kLayeredChunked = 3;
  static constexpr std::uint32_t kVariableChunks = 0xffffffffu;

  std::uint16_t compressor = kChunked;
  std::uint32_t chunkSize = 0;       ///< points, kVariableChunks = the chunk table says; 0 for kPointwise
  std::vector<std::uint8_t> record;  ///< the LASzip record itself
};

/// Throws Error, naming `file`, when `head` has no LASzip record or one that does not fit its header.
LazFormat parseLazFormat(const std::string& file, const LasHead& head);

/// A LASzip record's bytes with another chunk size.
std::vector<std::uint8_t> withChunkSize(const LazFormat& format, std::uint32_t chunkSize);

/// Points that are compressed together, so decoding can start here.
struct LazChunk {
  std::uint64_t offset = 0;  ///< in the file
  std::uint64_t bytes = 0;
  std::uint64_t points = 0;  ///< for chunks of equal size the last one's may be an overestimate
};

/// Where the chunk table is: after the 8 bytes at the start of point data, or in the last 8 bytes of the file.
/// 0 when the compressor was stopped before it wrote one. Throws Error when it is outside of the file.
std::uint64_t chunkTableOffset(const ByteSource& file, const LasHeader& header);

/// Decodes the chunk table. Throws Error when it is damaged or names bytes that are not there.
std::vector<LazChunk> readChunkTable(const ByteSource& file, const LasHeader& header, const LazFormat& format,
                                     std::uint64_t tableOffset);

}  // namespace strata
