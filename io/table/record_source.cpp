#include "io/table/record_source.h"

#include <algorithm>
#include <span>
#include <utility>

#include "core/error.h"
#include "io/table/record_mapping.h"
#include "io/table/record_sample.h"

namespace strata {
namespace {

constexpr std::uint64_t kPartPoints = std::uint64_t{1} << 20;
constexpr std::uint64_t kSamplePoints = std::uint64_t{1} << 20;
constexpr std::uint64_t kSampleRuns = 64;
constexpr std::size_t kBlockBytes = std::size_t{1} << 20;

std::size_t recordsPerBlock(std::size_t recordBytes) { return std::max<std::size_t>(1, kBlockBytes / recordBytes); }

/// Reverses the bytes of every number of every record.
void swapBytes(std::span<std::byte> records, std::size_t recordBytes, const std::vector<Field>& fields) {
  for (std::size_t at = 0; at + recordBytes <= records.size(); at += recordBytes)
    for (const Field& field : fields) {
      const std::size_t size = scalarBytes(field.type);
      if (size == 1) continue;
      for (std::uint32_t k = 0; k < field.count; ++k) {
        std::byte* value = records.data() + at + field.offset + k * size;
        std::reverse(value, value + size);
      }
    }
}

/// Reads `count` records from number `first` on and makes them little-endian.
void readRecords(const ByteSource& bytes, const RecordFile& file, std::uint64_t first, std::size_t count,
                 std::vector<std::byte>& out) {
  out.resize(count * file.recordBytes);
  bytes.read(file.dataOffset + first * file.recordBytes, out);
  if (file.bigEndian) swapBytes(out, file.recordBytes, file.fields);
}

class RecordReader final : public PointReader {
 public:
  RecordReader(const ByteSource& bytes, const RecordFile& file, const RecordMapping& mapping, std::uint64_t first,
               std::uint64_t end)
      : bytes_(bytes), file_(file), mapping_(mapping), next_(first), end_(end) {}

  bool read(PointBlock& block, std::size_t maxPoints) override {
    block.positions.clear();
    block.attributes.clear();
    while (block.count() < maxPoints && next_ < end_) {
      const std::uint64_t wanted =
          std::min<std::uint64_t>({maxPoints - block.count(), end_ - next_, recordsPerBlock(file_.recordBytes)});
      readRecords(bytes_, file_, next_, static_cast<std::size_t>(wanted), buffer_);
      mapping_.append(buffer_.data(), file_.recordBytes, static_cast<std::size_t>(wanted), block);
      next_ += wanted;
    }
    return block.count() > 0;
  }

 private:
  const ByteSource& bytes_;
  const RecordFile& file_;
  const RecordMapping& mapping_;
  std::uint64_t next_;
  std::uint64_t end_;
  std::vector<std::byte> buffer_;
};

class RecordSource final : public PointSource {
 public:
  RecordSource(std::unique_ptr<ByteSource> bytes, RecordFile file) : bytes_(std::move(bytes)), file_(std::move(file)) {
    readable_ = checkedCount();
    const RecordSample sample = lookAtSome();
    mapping_ = RecordMapping(bytes_->name(), file_.fields, sample.ranges);
    info_.path = bytes_->name();
    info_.format = file_.format;
    info_.pointCount = file_.pointCount;
    describePositions(mapping_, sample, sample.points == readable_, info_);
    info_.layout = mapping_.layout();
    info_.fileBytes = bytes_->size();
    info_.uncompressedBytes = bytes_->size();
    info_.viewpoint = file_.viewpoint;
  }

  const SourceInfo& info() const override { return info_; }
  std::size_t partCount() const override {
    return static_cast<std::size_t>((readable_ + kPartPoints - 1) / kPartPoints);
  }
  std::unique_ptr<PointReader> openPart(std::size_t part) const override {
    const std::uint64_t first = part * kPartPoints;
    return std::make_unique<RecordReader>(*bytes_, file_, mapping_, first, std::min(first + kPartPoints, readable_));
  }

 private:
  /// The number of points that the file really has.
  std::uint64_t checkedCount() const {
    const std::uint64_t rest = bytes_->size() - std::min(bytes_->size(), file_.dataOffset);
    if (file_.recordBytes == 0) throw Error(bytes_->name(), "its points have no fields");
    if (file_.pointCount > rest / file_.recordBytes && !file_.skipDamaged)
      throw Error(bytes_->name(), "the file ends early, found " + std::to_string(rest / file_.recordBytes) +
                                      " points (expected " + std::to_string(file_.pointCount) + ")");
    return std::min(file_.pointCount, rest / file_.recordBytes);
  }

  RecordSample lookAtSome() const {
    RecordSample sample;
    sample.ranges.resize(file_.fields.size());
    std::vector<std::byte> buffer;
    const std::uint64_t block = recordsPerBlock(file_.recordBytes);
    const auto look = [&](std::uint64_t first, std::uint64_t end) {
      for (; first < end; first += block) {
        readRecords(*bytes_, file_, first, static_cast<std::size_t>(std::min(block, end - first)), buffer);
        addToSample(sample, file_.fields, buffer, file_.recordBytes);
      }
    };
    if (readable_ <= kSamplePoints) {
      look(0, readable_);
    } else {
      const std::uint64_t length = kSamplePoints / kSampleRuns / 16;
      for (std::uint64_t run = 0; run < kSampleRuns; ++run) {
        const std::uint64_t first = (readable_ - length) / (kSampleRuns - 1) * run;
        look(first, first + length);
      }
    }
    return sample;
  }

  std::unique_ptr<ByteSource> bytes_;
  RecordFile file_;
  std::uint64_t readable_ = 0;
  RecordMapping mapping_;
  SourceInfo info_;
};

}  // namespace

std::unique_ptr<PointSource> openRecords(std::unique_ptr<ByteSource> bytes, RecordFile file) {
  return std::make_unique<RecordSource>(std::move(bytes), std::move(file));
}

}  // namespace strata
