#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "core/error.h"
#include "io/file/part_file.h"
#include "io/las/las_export_layout.h"
#include "io/las/las_header.h"
#include "io/las/laz_codec.h"
#include "io/scan/scan_writer.h"

namespace strata {
namespace {

constexpr std::size_t kBatchPoints = 4096;
constexpr double kAngleUnit = 0.006;  // degrees, of formats 6 to 10

class LasWriter final : public ScanWriter {
 public:
  LasWriter(const std::string& path, const StoreInfo& info, const ExportedPoints& points,
            const LasWriterOptions& options)
      : path_(path),
        layout_(chooseLasExportLayout(path, info, points, options.pointFormat)),
        stride_(info.layout.stride()),
        vlrs_(layout_.meta.vlrs),
        file_(path) {
    if (options.compress) {
      encoder_.emplace(*file_, layout_.format);
      vlrs_.push_back({"laszip encoded", 22204, "by LASzip", encoder_->record()});
    }
    LasTotals planned;
    planned.points = points.count;
    file_->append(encodeLasHead(path_, layout_.meta, vlrs_, options.compress, planned));
    if (encoder_) encoder_->start();
  }

  void write(const NodePoints& points) override {
    for (std::size_t done = 0; done < points.count(); done += kBatchPoints)
      writeBatch(points, done, std::min(kBatchPoints, points.count() - done));
  }

  void finish() override {
    if (encoder_) encoder_->finish();
    totals_.evlrStart = file_->size();
    if (layout_.meta.versionMinor >= 4) file_->append(encodeEvlrs(vlrs_));
    if (totals_.points != 0) {
      for (int axis = 0; axis < 3; ++axis) {
        const double scale = layout_.meta.scale[axis], offset = layout_.meta.offset[axis];
        totals_.bounds.min[axis] = std::min(first_[axis] * scale, last_[axis] * scale) + offset;
        totals_.bounds.max[axis] = std::max(first_[axis] * scale, last_[axis] * scale) + offset;
      }
    }
    file_->writeAt(0, encodeLasHead(path_, layout_.meta, vlrs_, encoder_.has_value(), totals_));
    file_.keep();
  }

 private:
  void writeBatch(const NodePoints& points, std::size_t first, std::size_t count) {
    integers_.resize(count);
    for (int axis = 0; axis < 3; ++axis)
      for (std::size_t i = 0; i < count; ++i) integers_[i][axis] = toInteger(points.grid[axis][first + i], axis);
    const std::byte* packed = points.attributes.data() + first * stride_;
    if (!layout_.sameRecords) packed = repack(packed, count);
    const std::size_t packedBytes = lasStride(layout_.format);
    for (std::size_t i = 0; i < count; ++i) {
      ++totals_.byReturn[std::min(static_cast<std::size_t>(packed[i * packedBytes + 2]), std::size_t{15})];
      first_ = glm::min(first_, integers_[i]);
      last_ = glm::max(last_, integers_[i]);
    }
    records_.resize(count * layout_.format.recordBytes);
    packLasRecords(layout_.format, integers_, packed, records_.data());
    if (encoder_)
      encoder_->write(records_);
    else
      file_->append(records_);
    totals_.points += count;
  }

  std::int32_t toInteger(std::int64_t stored, int axis) const {
    const std::int64_t integer = (stored + layout_.shift[axis]) / layout_.divide[axis];
    if (integer < std::numeric_limits<std::int32_t>::min() || integer > std::numeric_limits<std::int32_t>::max())
      throw Error(path_, "a point lies outside of the stated bounds, found coordinate " + std::to_string(integer) +
                             " (expected 32 bits)");
    return static_cast<std::int32_t>(integer);
  }

  /// Turns the store's records into packed records of the file. Fields that the store does not have are 0.
  const std::byte* repack(const std::byte* stored, std::size_t count) {
    const std::size_t packedBytes = lasStride(layout_.format);
    packed_.assign(count * packedBytes, std::byte{0});
    for (std::size_t i = 0; i < count; ++i) {
      const std::byte* from = stored + i * stride_;
      std::byte* to = packed_.data() + i * packedBytes;
      for (const LasExportLayout::Copy& copy : layout_.copies) std::memcpy(to + copy.to, from + copy.from, copy.bytes);
      if (layout_.rankAt >= 0) addAngle(static_cast<std::int8_t>(from[layout_.rankAt]), to + layout_.angleAt);
    }
    return packed_.data();
  }

  /// Every point of a store has its angle as a rank or as an angle; the other one is 0.
  static void addAngle(std::int8_t rank, std::byte* field) {
    std::int16_t angle = 0;
    std::memcpy(&angle, field, sizeof angle);
    if (rank != 0) angle = static_cast<std::int16_t>(std::lround(rank / kAngleUnit));
    std::memcpy(field, &angle, sizeof angle);
  }

  std::string path_;
  LasExportLayout layout_;
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

std::unique_ptr<ScanWriter> createLasWriter(const std::string& path, const StoreInfo& info,
                                            const ExportedPoints& points, const LasWriterOptions& options) {
  return std::make_unique<LasWriter>(path, info, points, options);
}

}  // namespace strata
