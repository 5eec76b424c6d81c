#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/file/byte_source.h"
#include "io/las/las_header.h"

namespace strata {

/// How points are compressed, as the LASzip VLR says. It is checked against the header, so that it can do no harm in
/// the LASzip library.
struct LazFormat {
  static constexpr std::uint16_t kPointwise = 1;  ///< one stream without chunks
  static constexpr std::uint16_t kChunked = 2;
  static constexpr std::uint16_t kLayeredChunked = 3;
  static constexpr std::uint32_t kVariableChunks = 0xffffffffu;

  std::uint16_t compressor = kChunked;
  std::uint32_t chunkSize = 0;       ///< points, or kVariableChunks when the chunk table says; 0 for kPointwise
  std::vector<std::uint8_t> record;  ///< the data of the LASzip VLR
};

/// Decodes the LASzip VLR. Throws Error naming `file` when `head` has none or one that does not fit its header.
LazFormat parseLazFormat(const std::string& file, const LasHead& head);

/// The data of the LASzip VLR with another chunk size.
std::vector<std::uint8_t> withChunkSize(const LazFormat& format, std::uint32_t chunkSize);

/// Points that are compressed together. Decoding can start at any chunk.
struct LazChunk {
  std::uint64_t offset = 0;  ///< in the file
  std::uint64_t bytes = 0;
  std::uint64_t points = 0;  ///< the last of equal chunks may have fewer
};

/// The offset of the chunk table, as the first 8 bytes of the point data or the last 8 bytes of the file say. 0 when
/// the compressor was stopped before it wrote one. Throws Error when it lies outside of the file.
std::uint64_t chunkTableOffset(const ByteSource& file, const LasHeader& header);

/// Decodes the chunk table. Throws Error when it is damaged or names bytes that are not there.
std::vector<LazChunk> readChunkTable(const ByteSource& file, const LasHeader& header, const LazFormat& format,
                                     std::uint64_t tableOffset);

}  // namespace strata
