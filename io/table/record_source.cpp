#include "io/table/record_source.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace strata {
namespace {

constexpr std::uint64_t kPartPoints = std::uint64_t{1} << 20;
constexpr std::uint64_t kSamplePoints = std::uint64_t{1} << 20;
constexpr std::uint64_t kSampleRuns = 64;
constexpr std::size_t kBlockBytes = std::size_t{1} << 20;

std::size_t recordsPerBlock(std::size_t recordBytes) { return std::max<std::size_t>(1, kBlockBytes / recordBytes); }

constexpr double kPowersOfTen[] = {1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};

/// Raises `decimals` to what `value` needs to be integer * 10^-decimals but for rounding: two units in its last place
/// or 1e-12, as where scale * integer + offset was computed. Digits within that rounding do not count as a grid.
void countDecimals(double value, int& decimals) {
  const double rounding = std::max(std::abs(value) * 4.5e-16, 1e-12);
  for (; decimals < RecordSample::kManyDecimals; ++decimals) {
    if (8.0 * rounding * kPowersOfTen[decimals] > 1.0)
      decimals = RecordSample::kManyDecimals - 1;  // the grid would be finer than the numbers are
    else if (std::abs(std::round(value * kPowersOfTen[decimals]) / kPowersOfTen[decimals] - value) <= rounding)
      return;
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
  RecordReader(const ByteSource& bytes, const RecordFile& file, const FieldMap& map, std::uint64_t first,
               std::uint64_t end)
      : bytes_(bytes), file_(file), map_(map), next_(first), end_(end) {}

  bool read(PointBlock& block, std::size_t maxPoints) override {
    block.positions.clear();
    block.attributes.clear();
    while (block.count() < maxPoints && next_ < end_) {
      const std::uint64_t wanted =
          std::min<std::uint64_t>({maxPoints - block.count(), end_ - next_, recordsPerBlock(file_.recordBytes)});
      readRecords(bytes_, file_, next_, static_cast<std::size_t>(wanted), buffer_);
      appendRecords(map_, buffer_.data(), file_.recordBytes, static_cast<std::size_t>(wanted), block);
      next_ += wanted;
    }
    return block.count() > 0;
  }

 private:
  const ByteSource& bytes_;
  const RecordFile& file_;
  const FieldMap& map_;
  std::uint64_t next_;
  std::uint64_t end_;
  std::vector<std::byte> buffer_;
};

class RecordSource final : public PointSource {
 public:
  RecordSource(std::unique_ptr<ByteSource> bytes, RecordFile file) : bytes_(std::move(bytes)), file_(std::move(file)) {
    readable_ = checkedCount();
    const RecordSample sample = lookAtSome();
    map_ = FieldMap(bytes_->name(), file_.fields, sample.ranges);
    info_.path = bytes_->name();
    info_.format = file_.format;
    info_.pointCount = file_.pointCount;
    describePositions(map_, sample, sample.points == readable_, info_);
    info_.layout = map_.layout();
    info_.fileBytes = bytes_->size();
    info_.uncompressedBytes = bytes_->size();
  }

  const SourceInfo& info() const override { return info_; }
  std::size_t partCount() const override {
    return static_cast<std::size_t>((readable_ + kPartPoints - 1) / kPartPoints);
  }
  std::unique_ptr<PointReader> openPart(std::size_t part) const override {
    const std::uint64_t first = part * kPartPoints;
    return std::make_unique<RecordReader>(*bytes_, file_, map_, first, std::min(first + kPartPoints, readable_));
  }

 private:
  /// How many points the file really has.
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
  FieldMap map_;
  SourceInfo info_;
};

}  // namespace

void addToSample(RecordSample& sample, const std::vector<Field>& fields, std::span<const std::byte> records,
                 std::size_t recordBytes) {
  const AxisFields axes = findAxes(fields);
  const bool placed = std::all_of(std::begin(axes.index), std::end(axes.index), [](int i) { return i >= 0; });
  for (std::size_t at = 0; at + recordBytes <= records.size(); at += recordBytes) {
    const std::byte* record = records.data() + at;
    for (std::size_t i = 0; i < fields.size(); ++i)
      sample.ranges[i].add(loadScalar(record + fields[i].offset, fields[i].type));
    ++sample.points;
    if (!placed) continue;
    glm::dvec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      const Field& field = fields[static_cast<std::size_t>(axes.index[axis])];
      p[axis] = loadScalar(record + field.offset, field.type);
    }
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) continue;
    sample.bounds.add(p);
    for (int axis = 0; axis < 3; ++axis) countDecimals(p[axis], sample.decimals);
  }
}

void describePositions(const FieldMap& map, const RecordSample& sample, bool complete, SourceInfo& info) {
  info.boundsExact = complete;
  if (complete) info.bounds = sample.bounds;
  if (sample.bounds.empty()) return;
  const bool anyFloat32 =
      map.axis(0).type == ScalarType::f32 || map.axis(1).type == ScalarType::f32 || map.axis(2).type == ScalarType::f32;
  if (complete && !anyFloat32 && sample.decimals < RecordSample::kManyDecimals) {
    info.step = glm::dvec3(1.0 / kPowersOfTen[sample.decimals]);
    info.gridExact = true;
    return;
  }
  glm::dvec3 step(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    const double largest = std::max(std::abs(sample.bounds.min[axis]), std::abs(sample.bounds.max[axis]));
    switch (map.axis(axis).type) {
      case ScalarType::f32:
        step[axis] = float32Step(largest);
        break;
      case ScalarType::f64:
        step[axis] = float64Step(sample.bounds);
        info.float64 = true;
        break;
      default:
        step[axis] = 1.0;
    }
  }
  info.step = fillSteps(step);
}

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

void appendRecords(const FieldMap& map, const std::byte* records, std::size_t recordBytes, std::size_t count,
                   PointBlock& block) {
  const std::size_t stride = map.layout().stride();
  const std::size_t before = block.count();
  block.positions.resize(before + count);
  block.attributes.resize((before + count) * stride);
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* record = records + i * recordBytes;
    block.positions[before + i] = map.position(record);
    if (stride > 0) map.attributes(record, block.attributes.data() + (before + i) * stride);
  }
}

std::unique_ptr<PointSource> openRecords(std::unique_ptr<ByteSource> bytes, RecordFile file) {
  return std::make_unique<RecordSource>(std::move(bytes), std::move(file));
}

}  // namespace strata
