#include "io/las/las_source.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "core/error.h"
#include "core/log.h"
#include "io/las/las_header.h"
#include "io/las/las_record.h"
#include "io/las/las_vlr.h"
#include "io/las/laz_source.h"

namespace strata {
namespace {

constexpr std::uint64_t kPartPoints = std::uint64_t{1} << 20;
constexpr std::size_t kSliceBytes = std::size_t{256} << 10;  // read and unpacked while it is in the cache

/// Uncompressed records, read straight from the file.
class LasSource final : public PointSource {
 public:
  LasSource(std::unique_ptr<ByteSource> file, const LasHeader& header, SourceInfo info, std::uint64_t points)
      : file_(std::move(file)),
        info_(std::move(info)),
        format_{header.pointFormat, header.recordBytes},
        scale_(header.scale),
        pointsOffset_(header.pointsOffset),
        points_(points) {}

  const SourceInfo& info() const override { return info_; }
  std::size_t partCount() const override { return static_cast<std::size_t>((points_ + kPartPoints - 1) / kPartPoints); }
  std::unique_ptr<PointReader> openPart(std::size_t part) const override { return open(part, false); }
  std::unique_ptr<PointReader> openIntegers(std::size_t part) const override { return open(part, true); }

  void readRecords(std::uint64_t first, std::span<std::byte> records) const {
    file_->read(pointsOffset_ + first * format_.recordBytes, records);
  }
  const LasRecordFormat& format() const { return format_; }
  const glm::dvec3& scale() const { return scale_; }

 private:
  std::unique_ptr<PointReader> open(std::size_t part, bool integers) const;

  std::unique_ptr<ByteSource> file_;
  SourceInfo info_;
  LasRecordFormat format_;
  glm::dvec3 scale_;
  std::uint64_t pointsOffset_;
  std::uint64_t points_;  ///< that the file really has
};

class LasReader final : public PointReader {
 public:
  LasReader(const LasSource& source, std::uint64_t first, std::uint64_t end, bool integers)
      : source_(source),
        integers_(integers),
        next_(first),
        end_(end),
        slice_(std::max<std::size_t>(1, kSliceBytes / source.format().recordBytes) * source.format().recordBytes) {}

  bool read(PointBlock& block, std::size_t maxPoints) override {
    if (integers_)
      return readInto(block, maxPoints, block.integers, [&](std::span<glm::ivec3> integers, std::byte* attributes) {
        unpackLasRecords(source_.format(), slice_.data(), integers, attributes);
      });
    return readInto(block, maxPoints, block.positions, [&](std::span<glm::dvec3> positions, std::byte* attributes) {
      unpackLasRecords(source_.format(), source_.scale(), slice_.data(), positions, attributes);
    });
  }

 private:
  template <typename Position, typename Unpack>
  bool readInto(PointBlock& block, std::size_t maxPoints, std::vector<Position>& positions, Unpack unpack) {
    const LasRecordFormat& format = source_.format();
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(maxPoints, end_ - next_));
    const std::size_t stride = lasStride(format);
    positions.resize(count);
    block.attributes.resize(count * stride);
    const std::size_t slicePoints = slice_.size() / format.recordBytes;
    for (std::size_t done = 0; done < count;) {
      const std::size_t points = std::min(slicePoints, count - done);
      source_.readRecords(next_, std::span(slice_).first(points * format.recordBytes));
      unpack(std::span(positions).subspan(done, points), block.attributes.data() + done * stride);
      done += points;
      next_ += points;
    }
    return count != 0;
  }

  const LasSource& source_;
  const bool integers_;
  std::uint64_t next_;
  std::uint64_t end_;
  std::vector<std::byte> slice_;
};

std::unique_ptr<PointReader> LasSource::open(std::size_t part, bool integers) const {
  const std::uint64_t first = part * kPartPoints;
  return std::make_unique<LasReader>(*this, first, std::min(first + kPartPoints, points_), integers);
}

LasMeta metaOf(const LasHead& head) {
  const LasHeader& header = head.header;
  LasMeta meta;
  meta.versionMinor = header.versionMinor;
  meta.pointFormat = header.pointFormat;
  meta.recordBytes = header.recordBytes;
  meta.scale = header.scale;
  meta.offset = header.offset;
  meta.globalEncoding = header.globalEncoding;
  meta.fileSourceId = header.fileSourceId;
  meta.creationDay = header.creationDay;
  meta.creationYear = header.creationYear;
  meta.systemIdentifier = header.systemIdentifier;
  meta.generatingSoftware = header.generatingSoftware;
  for (const LasMeta::Vlr& vlr : head.vlrs)
    if (!isLaszip(vlr) && !isCopc(vlr)) meta.vlrs.push_back(vlr);
  return meta;
}

/// The header's bounds, cut to what its grid can reach. They are a hint, since headers are wrong more often than
/// points.
Box plausibleBounds(const LasHeader& header) {
  if (header.bounds.empty()) return {};
  constexpr double kFirst = std::numeric_limits<std::int32_t>::min(), kLast = std::numeric_limits<std::int32_t>::max();
  Box reach;
  reach.add(header.offset + header.scale * kFirst);
  reach.add(header.offset + header.scale * kLast);
  const Box bounds{glm::max(header.bounds.min, reach.min), glm::min(header.bounds.max, reach.max)};
  return bounds.empty() ? Box() : bounds;
}

SourceInfo infoOf(const std::string& path, const LasHead& head, std::uint64_t fileBytes) {
  const LasHeader& header = head.header;
  SourceInfo info;
  info.path = path;
  const bool copc = std::any_of(head.vlrs.begin(), head.vlrs.end(), isCopc);
  info.format = std::string(!header.compressed ? "LAS"
                            : copc             ? "COPC"
                                               : "LAZ") +
                " 1." + std::to_string(header.versionMinor) + " format " + std::to_string(header.pointFormat);
  info.pointCount = header.pointCount;
  info.bounds = plausibleBounds(header);
  info.origin = header.offset;
  info.step = glm::abs(header.scale);
  info.gridExact = true;
  info.layout = lasLayout({header.pointFormat, header.recordBytes}, head.vlrs);
  info.crs = lasCrs(head.vlrs);
  info.fileBytes = fileBytes;
  info.las = metaOf(head);
  return info;
}

/// Warns when the file has room for points behind those that its header counts, unless waveforms may lie there.
void warnOfMore(const LasHeader& header, const std::string& path, std::uint64_t points, std::uint64_t fileBytes) {
  const bool waveforms = header.pointFormat == 4 || header.pointFormat == 5 || header.pointFormat >= 9;
  const bool evlrs = header.evlrCount > 0 && header.evlrStart >= header.pointsOffset && header.evlrStart <= fileBytes;
  const std::uint64_t end = evlrs ? header.evlrStart : fileBytes;
  const std::uint64_t room = (end - header.pointsOffset) / header.recordBytes;
  if (!waveforms && room > points)
    logWarning(path + ": the header counts " + std::to_string(points) + " points, found room for " +
               std::to_string(room - points) + " more behind them, which are not read");
}

}  // namespace

std::unique_ptr<PointSource> openLas(const std::string& path, const SourceOptions& options) {
  if (std::filesystem::is_directory(path)) throw Error(path, "not a file, found a folder (expected a LAS or LAZ file)");
  std::unique_ptr<ByteSource> file = openFile(path);
  const LasHead head = readLasHead(*file);
  const LasHeader& header = head.header;
  SourceInfo info = infoOf(path, head, file->size());
  if (header.compressed) return openLaz(std::move(file), head, std::move(info), options);

  const std::uint64_t whole = (file->size() - header.pointsOffset) / header.recordBytes;
  // Some writers keep both counts but fill in one. The count that the file has room for is right.
  if (info.pointCount > whole && header.legacyPointCount != 0 && header.legacyPointCount <= whole)
    info.pointCount = header.legacyPointCount;
  if (info.pointCount > whole && !options.skipDamaged)
    throw Error(path, "the file ends early, found " + std::to_string(whole) + " points (expected " +
                          std::to_string(info.pointCount) + ")");
  const std::uint64_t points = std::min(info.pointCount, whole);
  warnOfMore(header, path, points, file->size());
  info.uncompressedBytes = points * header.recordBytes;
  return std::make_unique<LasSource>(std::move(file), header, std::move(info), points);
}

}  // namespace strata
