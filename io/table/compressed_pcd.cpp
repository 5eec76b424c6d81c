#include "io/table/compressed_pcd.h"

#include <pcl/io/lzf.h>

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/table/record_mapping.h"
#include "io/table/record_sample.h"

namespace strata {
namespace {

constexpr std::size_t kBlockPoints = 4096;

/// An unpacked cloud: all values of the first field, then all of the second, and so on.
class Columns {
 public:
  Columns(std::vector<std::byte> bytes, const PcdHeader& header) : bytes_(std::move(bytes)), header_(header) {}

  /// Gathers the points first to first + count as records.
  void gather(std::uint64_t first, std::size_t count, std::vector<std::byte>& records) const {
    records.resize(count * header_.recordBytes);
    for (const Field& field : header_.fields) {
      const std::size_t size = field.bytes();
      const std::byte* from = bytes_.data() + field.offset * header_.points + first * size;
      std::byte* to = records.data() + field.offset;
      for (std::size_t i = 0; i < count; ++i, from += size, to += header_.recordBytes) std::memcpy(to, from, size);
    }
  }

 private:
  std::vector<std::byte> bytes_;
  const PcdHeader& header_;
};

/// Unpacks the body of a file. Before it come its packed and its unpacked size, 32 bits each.
Columns unpack(const ByteSource& bytes, const PcdHeader& header, std::uint64_t memoryBytes) {
  std::uint32_t sizes[2] = {};
  if (bytes.size() < header.headerBytes + sizeof sizes)
    throw Error(bytes.name(), "the file ends early, found no compressed points");
  bytes.read(header.headerBytes, std::as_writable_bytes(std::span(sizes)));
  const std::uint64_t rest = bytes.size() - header.headerBytes - sizeof sizes;
  if (header.points > sizes[1] / header.recordBytes || sizes[1] != header.points * header.recordBytes)
    throw Error(bytes.name(), "found " + std::to_string(sizes[1]) + " bytes of points (expected " +
                                  std::to_string(header.points) + " points of " + std::to_string(header.recordBytes) +
                                  " bytes)");
  if (sizes[0] > rest)
    throw Error(bytes.name(), "the file ends early, found " + std::to_string(rest) + " compressed bytes (expected " +
                                  std::to_string(sizes[0]) + ")");
  if (std::uint64_t{sizes[0]} + sizes[1] > memoryBytes)
    throw Error(bytes.name(), "compressed PCD must be held in memory whole, which takes " +
                                  std::to_string((std::uint64_t{sizes[0]} + sizes[1]) >> 20) +
                                  " MB (expected at most " + std::to_string(memoryBytes >> 20) +
                                  "); give more memory or convert it to PCD binary");
  std::vector<std::byte> packed(sizes[0]);
  bytes.read(header.headerBytes + sizeof sizes, packed);
  std::vector<std::byte> unpacked(sizes[1]);
  if (sizes[1] > 0 && pcl::lzfDecompress(packed.data(), sizes[0], unpacked.data(), sizes[1]) != sizes[1])
    throw Error(bytes.name(), "its compressed points are damaged");
  return Columns(std::move(unpacked), header);
}

class ColumnsReader final : public PointReader {
 public:
  ColumnsReader(Columns columns, const PcdHeader& header, const RecordMapping& mapping)
      : columns_(std::move(columns)), header_(header), mapping_(mapping) {}

  bool read(PointBlock& block, std::size_t maxPoints) override {
    block.positions.clear();
    block.attributes.clear();
    while (block.count() < maxPoints && next_ < header_.points) {
      const auto count = static_cast<std::size_t>(
          std::min<std::uint64_t>({maxPoints - block.count(), kBlockPoints, header_.points - next_}));
      columns_.gather(next_, count, records_);
      mapping_.append(records_.data(), header_.recordBytes, count, block);
      next_ += count;
    }
    return block.count() > 0;
  }

 private:
  Columns columns_;
  const PcdHeader& header_;
  const RecordMapping& mapping_;
  std::uint64_t next_ = 0;
  std::vector<std::byte> records_;
};

class CompressedPcdSource final : public PointSource {
 public:
  CompressedPcdSource(std::unique_ptr<ByteSource> bytes, PcdHeader header, std::uint64_t memoryBytes)
      : bytes_(std::move(bytes)), header_(std::move(header)), memoryBytes_(memoryBytes) {
    const Columns columns = unpack(*bytes_, header_, memoryBytes_);
    RecordSample sample;
    sample.ranges.resize(header_.fields.size());
    std::vector<std::byte> records;
    for (std::uint64_t first = 0; first < header_.points; first += kBlockPoints) {
      const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kBlockPoints, header_.points - first));
      columns.gather(first, count, records);
      addToSample(sample, header_.fields, records, header_.recordBytes);
    }
    mapping_ = RecordMapping(bytes_->name(), header_.fields, sample.ranges);
    info_.path = bytes_->name();
    info_.format = "PCD binary_compressed";
    info_.pointCount = header_.points;
    describePositions(mapping_, sample, true, info_);
    info_.layout = mapping_.layout();
    info_.fileBytes = bytes_->size();
    info_.uncompressedBytes = header_.points * header_.recordBytes;
    info_.viewpoint = header_.viewpoint;
  }

  const SourceInfo& info() const override { return info_; }
  std::size_t partCount() const override { return header_.points > 0 ? 1 : 0; }
  std::unique_ptr<PointReader> openPart(std::size_t) const override {
    return std::make_unique<ColumnsReader>(unpack(*bytes_, header_, memoryBytes_), header_, mapping_);
  }

 private:
  std::unique_ptr<ByteSource> bytes_;
  PcdHeader header_;
  std::uint64_t memoryBytes_;
  RecordMapping mapping_;
  SourceInfo info_;
};

}  // namespace

std::unique_ptr<PointSource> openCompressedPcd(std::unique_ptr<ByteSource> bytes, const PcdHeader& header,
                                               std::uint64_t memoryBytes) {
  return std::make_unique<CompressedPcdSource>(std::move(bytes), header, memoryBytes);
}

}  // namespace strata
