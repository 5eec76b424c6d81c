#include "io/las/laz_header.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "io/las/las_vlr.h"
#include "io/las/laz_integers.h"

namespace strata {
namespace {

constexpr std::size_t kRecordHead = 34;  // bytes before the items
constexpr std::size_t kChunkSizeAt = 12;
constexpr std::size_t kItemBytes = 6;

template <typename T>
T load(const void* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// The kinds of items, with LASzip's numbers.
enum Item : std::uint16_t {
  kBytes = 0,
  kPoint10 = 6,
  kGpsTime11 = 7,
  kRgb12 = 8,
  kWavePacket13 = 9,
  kPoint14 = 10,
  kRgb14 = 11,
  kRgbNir14 = 12,
  kWavePacket14 = 13,
  kBytes14 = 14
};

struct ItemSize {
  std::uint16_t type;
  std::uint16_t bytes;
};

/// The items that records of this format are cut into, in order.
std::vector<ItemSize> expectedItems(const LasHeader& header) {
  std::vector<ItemSize> items;
  const int id = header.pointFormat;
  if (id < 6) {
    items.push_back({kPoint10, 20});
    if (id == 1 || id >= 3) items.push_back({kGpsTime11, 8});
    if (id == 2 || id == 3 || id == 5) items.push_back({kRgb12, 6});
    if (id == 4 || id == 5) items.push_back({kWavePacket13, 29});
  } else {
    items.push_back({kPoint14, 30});
    if (id == 7) items.push_back({kRgb14, 6});
    if (id == 8 || id == 10) items.push_back({kRgbNir14, 8});
    if (id == 9 || id == 10) items.push_back({kWavePacket14, 29});
  }
  const int extra = header.recordBytes - lasFormatBytes(id);
  if (extra > 0) items.push_back({id < 6 ? kBytes : kBytes14, static_cast<std::uint16_t>(extra)});
  return items;
}

/// True for versions that LASzip can decode. LASzip itself does not check whether a version fits the compressor.
bool versionFits(std::uint16_t type, std::uint16_t version, std::uint16_t compressor) {
  if (compressor == LazFormat::kLayeredChunked) return version == 3 || version == 4;
  if (type >= kPoint14) return version == 2;
  return version == 1 || (version == 2 && type != kWavePacket13);
}

void checkItems(const std::string& file, const LasHeader& header, const LazFormat& format) {
  const auto count = load<std::uint16_t>(format.record.data() + 32);
  const std::vector<ItemSize> expected = expectedItems(header);
  if (count != expected.size() || format.record.size() < kRecordHead + kItemBytes * expected.size())
    throw Error(file, "the LASzip record does not fit the point format, found " + std::to_string(count) +
                          " items (expected " + std::to_string(expected.size()) + ")");
  if (format.compressor == LazFormat::kLayeredChunked && header.pointFormat < 6)
    throw Error(file, "the LASzip record does not fit the point format, found layers (expected point format 6 to 10)");
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::uint8_t* item = format.record.data() + kRecordHead + kItemBytes * i;
    const auto type = load<std::uint16_t>(item), bytes = load<std::uint16_t>(item + 2),
               version = load<std::uint16_t>(item + 4);
    if (type != expected[i].type || bytes != expected[i].bytes)
      throw Error(file, "the LASzip record does not fit the point format, found item " + std::to_string(type) + " of " +
                            std::to_string(bytes) + " bytes (expected item " + std::to_string(expected[i].type) +
                            " of " + std::to_string(expected[i].bytes) + " bytes)");
    if (!versionFits(type, version, format.compressor))
      throw Error(file, "unknown compression of item " + std::to_string(type) + ", found version " +
                            std::to_string(version) + " (expected 1 to 4, as LASzip writes it)");
  }
}

}  // namespace

LazFormat parseLazFormat(const std::string& file, const LasHead& head) {
  const auto found = std::find_if(head.vlrs.begin(), head.vlrs.end(), isLaszip);
  if (found == head.vlrs.end()) throw Error(file, "the points are compressed, found no LASzip record (expected one)");
  if (found->data.size() < kRecordHead)
    throw Error(file, "the LASzip record is too short, found " + std::to_string(found->data.size()) +
                          " bytes (expected at least " + std::to_string(kRecordHead) + ")");
  LazFormat format;
  format.record = found->data;
  format.compressor = load<std::uint16_t>(format.record.data());
  if (format.compressor < LazFormat::kPointwise || format.compressor > LazFormat::kLayeredChunked)
    throw Error(file, "unknown LASzip compressor, found " + std::to_string(format.compressor) + " (expected 1 to 3)");
  const auto coder = load<std::uint16_t>(format.record.data() + 2);
  if (coder != 0) throw Error(file, "unknown LASzip coder, found " + std::to_string(coder) + " (expected 0)");
  if (format.compressor != LazFormat::kPointwise) {
    format.chunkSize = load<std::uint32_t>(format.record.data() + kChunkSizeAt);
    if (format.chunkSize == 0) format.chunkSize = LazFormat::kVariableChunks;  // as LASzip takes it
  }
  checkItems(file, head.header, format);
  return format;
}

std::vector<std::uint8_t> withChunkSize(const LazFormat& format, std::uint32_t chunkSize) {
  std::vector<std::uint8_t> record = format.record;
  std::memcpy(record.data() + kChunkSizeAt, &chunkSize, sizeof chunkSize);
  return record;
}

std::uint64_t chunkTableOffset(const ByteSource& file, const LasHeader& header) {
  std::byte field[8];
  const std::uint64_t start = header.pointsOffset;
  if (file.size() - start < sizeof field)
    throw Error(file.name(), "the file ends early, found no compressed points (expected a chunk table)");
  file.read(start, field);
  auto offset = load<std::uint64_t>(field);
  if (offset == ~std::uint64_t{0}) {  // written to a pipe
    file.read(file.size() - sizeof field, field);
    offset = load<std::uint64_t>(field);
  }
  if (offset == start) return 0;
  if (offset < start + 8)
    throw Error(file.name(), "the chunk table stands before the points, found offset " + std::to_string(offset) +
                                 " (expected at least " + std::to_string(start + 8) + ")");
  if (offset > file.size() || file.size() - offset < 8)
    throw Error(file.name(), "the file ends early, found " + std::to_string(file.size()) +
                                 " bytes (expected a chunk table at byte " + std::to_string(offset) + ")");
  return offset;
}

std::vector<LazChunk> readChunkTable(const ByteSource& file, const LasHeader& header, const LazFormat& format,
                                     std::uint64_t tableOffset) {
  const std::uint64_t first = std::uint64_t{header.pointsOffset} + 8;
  std::byte fields[8];
  file.read(tableOffset, fields);
  const auto version = load<std::uint32_t>(fields), count = load<std::uint32_t>(fields + 4);
  if (version != 0)
    throw Error(file.name(), "unknown version of the chunk table, found " + std::to_string(version) + " (expected 0)");
  // A chunk starts with one uncompressed record.
  const std::uint64_t most = (tableOffset - first) / header.recordBytes;
  if (count > most)
    throw Error(file.name(), "the chunk table is damaged, found " + std::to_string(count) +
                                 " chunks (expected at most " + std::to_string(most) + ")");
  // The integers of a chunk take at most 16 bytes, even when they compress badly.
  std::vector<std::byte> packed(
      static_cast<std::size_t>(std::min<std::uint64_t>(file.size() - tableOffset - 8, std::uint64_t{count} * 16 + 64)));
  file.read(tableOffset + 8, packed);

  std::vector<LazChunk> chunks;
  if (count == 0) return chunks;
  LazIntegers integers(file.name(), packed);
  LazChunk chunk{first, 0, 0};
  for (std::uint32_t i = 0; i < count; ++i) {
    if (format.chunkSize == LazFormat::kVariableChunks)
      chunk.points = integers.next(static_cast<std::uint32_t>(chunk.points), 0);
    else
      chunk.points = format.chunkSize;
    chunk.offset += chunk.bytes;
    chunk.bytes = integers.next(static_cast<std::uint32_t>(chunk.bytes), 1);
    if (chunk.bytes > tableOffset - chunk.offset)
      throw Error(file.name(), "the chunk table is damaged, found chunk " + std::to_string(i) + " of " +
                                   std::to_string(chunk.bytes) + " bytes (expected at most " +
                                   std::to_string(tableOffset - chunk.offset) + ")");
    chunks.push_back(chunk);
  }
  return chunks;
}

}  // namespace strata
