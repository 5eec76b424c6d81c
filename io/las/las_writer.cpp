#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>

#include "core/error.h"
#include "io/file/output_file.h"
#include "io/las/las_header.h"
#include "io/las/las_target.h"
#include "io/las/laz_codec.h"
#include "io/scan/scan_writer.h"

namespace strata {
namespace {

constexpr std::size_t kBatchPoints = 4096;
constexpr double kAngleUnit = 0.006;  // degrees, of formats 6 to 10

/// A file under construction; goes away unless keep() gives it its name.
class PartFile {
 public:
  explicit PartFile(const std::string& path) : path_(path), part_(path + ".part"), file_(std::in_place, part_) {}
  ~PartFile() {
    if (!file_) return;
    file_.reset();
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  OutputFile& operator*() { return *file_; }
  OutputFile* operator->() { return &*file_; }
  void keep() {
    file_->finish();
    std::error_code failure;
    std::filesystem::rename(part_, path_, failure);
    if (failure) throw Error(path_, "renaming " + part_ + ": " + failure.message());
    file_.reset();
  }

 private:
  std::string path_;
  std::string part_;
  std::optional<OutputFile> file_;
};

class LasWriter final : public ScanWriter {
 public:
  LasWriter(const std::string& path, const StoreInfo& info, std::uint64_t points, const Box& bounds, bool compress,
            std::optional<int> pointFormat)
      : path_(path),
        target_(chooseLasTarget(path, info, points, bounds, pointFormat)),
        stride_(info.layout.stride()),
        vlrs_(target_.meta.vlrs),
        file_(path) {
    if (compress) {
      encoder_.emplace(*file_, target_.format);
      vlrs_.push_back({"laszip encoded", 22204, "by LASzip", encoder_->record()});
    }
    LasTotals planned;
    planned.points = points;
    file_->append(encodeLasHead(path_, target_.meta, vlrs_, compress, planned));
    if (encoder_) encoder_->start();
  }

  void write(const NodePoints& points) override {
    for (std::size_t done = 0; done < points.count(); done += kBatchPoints)
      writeBatch(points, done, std::min(kBatchPoints, points.count() - done));
  }

  void finish() override {
    if (encoder_) encoder_->finish();
    totals_.evlrStart = file_->size();
    if (target_.meta.versionMinor >= 4) file_->append(encodeEvlrs(vlrs_));
    if (totals_.points != 0) {
      for (int axis = 0; axis < 3; ++axis) {
        const double scale = target_.meta.scale[axis], offset = target_.meta.offset[axis];
        totals_.bounds.min[axis] = std::min(first_[axis] * scale, last_[axis] * scale) + offset;
        totals_.bounds.max[axis] = std::max(first_[axis] * scale, last_[axis] * scale) + offset;
      }
    }
    file_->writeAt(0, encodeLasHead(path_, target_.meta, vlrs_, encoder_.has_value(), totals_));
    file_.keep();
  }

 private:
  void writeBatch(const NodePoints& points, std::size_t first, std::size_t count) {
    integers_.resize(count);
    for (int axis = 0; axis < 3; ++axis)
      for (std::size_t i = 0; i < count; ++i) integers_[i][axis] = toInteger(points.grid[axis][first + i], axis);
    const std::byte* packed = points.attributes.data() + first * stride_;
    if (!target_.sameRecords) packed = repack(packed, count);
    const std::size_t packedBytes = lasStride(target_.format);
    for (std::size_t i = 0; i < count; ++i) {
      ++totals_.byReturn[std::min(static_cast<std::size_t>(packed[i * packedBytes + 2]), std::size_t{15})];
      first_ = glm::min(first_, integers_[i]);
      last_ = glm::max(last_, integers_[i]);
    }
    records_.resize(count * target_.format.recordBytes);
    packLasRecords(target_.format, integers_, packed, records_.data());
    if (encoder_)
      encoder_->write(records_);
    else
      file_->append(records_);
    totals_.points += count;
  }

  std::int32_t toInteger(std::int64_t stored, int axis) const {
    const std::int64_t integer = (stored + target_.shift[axis]) / target_.divide[axis];
    if (integer < std::numeric_limits<std::int32_t>::min() || integer > std::numeric_limits<std::int32_t>::max())
      throw Error(path_, "a point lies outside of the stated bounds, found coordinate " + std::to_string(integer) +
                             " (expected 32 bits)");
    return static_cast<std::int32_t>(integer);
  }

  /// The store's records as packed records of the file's layout; fields that the store has not are 0.
  const std::byte* repack(const std::byte* stored, std::size_t count) {
    const std::size_t packedBytes = lasStride(target_.format);
    packed_.assign(count * packedBytes, std::byte{0});
    for (std::size_t i = 0; i < count; ++i) {
      const std::byte* from = stored + i * stride_;
      std::byte* to = packed_.data() + i * packedBytes;
      for (const LasTarget::Copy& copy : target_.copies) std::memcpy(to + copy.to, from + copy.from, copy.bytes);
      if (target_.rankAt >= 0) addAngle(static_cast<std::int8_t>(from[target_.rankAt]), to + target_.angleAt);
    }
    return packed_.data();
  }

  /// Points of a store have their angle as a rank or as an angle, the other is 0.
  static void addAngle(std::int8_t rank, std::byte* field) {
    std::int16_t angle = 0;
    std::memcpy(&angle, field, sizeof angle);
    if (rank != 0) angle = static_cast<std::int16_t>(std::lround(rank / kAngleUnit));
    std::memcpy(field, &angle, sizeof angle);
  }

  std::string path_;
  LasTarget target_;
  std::size_t stride_;  ///< of the store's records
  std::vector<LasMeta::Vlr> vlrs_;
  PartFile file_;
  std::optional<LazEncoder> encoder_;
  LasTotals totals_;
  glm::ivec3 first_{std::numeric_limits<std::int32_t>::max()};
  glm::ivec3 last_{std::numeric_limits<std::int32_t>::min()};
  std::vector<glm::ivec3> integers_;
  std::vector<std::byte> packed_;
  std::vector<std::byte> records_;
};

}  // namespace

std::unique_ptr<ScanWriter> createLasWriter(const std::string& path, const StoreInfo& info, std::uint64_t points,
                                            const Box& bounds, bool compress, std::optional<int> pointFormat) {
  return std::make_unique<LasWriter>(path, info, points, bounds, compress, pointFormat);
}

}  // namespace strata
