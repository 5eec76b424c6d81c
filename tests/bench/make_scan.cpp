// Writes a scan as LAS 1.2 format 2 (26 bytes a record), LAZ or PCD, its points in the order of the source: input for
// timing conversions, made without a store and without twice the disk.
#include <tbb/parallel_pipeline.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <span>

#include "core/error.h"
#include "core/program/exit_code.h"
#include "io/file/output_file.h"
#include "io/open_scans.h"
#include "io/scan/point_source.h"
#include "io/scan/scan_writer.h"

namespace strata {
namespace {

constexpr std::size_t kPartsAtOnce = 3;

/// A store's description that makes the LAS writer choose format 2 on the source's own grid.
StoreInfo describe(const SourceInfo& source) {
  StoreInfo info;
  info.points = source.pointCount;
  info.bounds = source.bounds;
  info.grid.scale = source.step;
  info.grid.offset = source.origin;
  info.layout = source.layout;
  info.ranges.resize(source.layout.attributes().size());
  info.sources.push_back({source.path, source.format, source.pointCount, 0});
  info.las.emplace();
  info.las->pointFormat = 2;
  info.las->recordBytes = 26;
  info.las->scale = source.step;
  info.las->offset = source.origin;
  return info;
}

/// Binary PCD of single-precision coordinates relative to the source's origin, and colour: what PCL's tools read.
class PcdWriter final : public ScanWriter {
 public:
  PcdWriter(const std::string& path, const StoreInfo& info) : info_(info), file_(path) {
    const int rgb = info.layout.find(attribute::kRgb);
    if (rgb < 0) throw Error(path, "the scan has no colour");
    rgbAt_ = info.layout.offset(static_cast<std::size_t>(rgb));
    const std::string count = std::to_string(info.points);
    const std::string header = "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH " +
                               count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
    file_.append(std::as_bytes(std::span(header)));
  }
  void write(const NodePoints& points) override {
    std::vector<std::array<float, 4>> records(points.count());
    for (std::size_t i = 0; i < points.count(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        records[i][axis] =
            static_cast<float>(static_cast<double>(points.grid[axis][i]) * info_.grid.scale[static_cast<int>(axis)]);
      std::uint16_t rgb[3];
      std::memcpy(rgb, points.attributes.data() + i * info_.layout.stride() + rgbAt_, sizeof rgb);
      const std::uint32_t packed = (rgb[0] >> 8u) << 16u | (rgb[1] >> 8u) << 8u | rgb[2] >> 8u;
      std::memcpy(&records[i][3], &packed, sizeof packed);
    }
    file_.append(std::as_bytes(std::span(records)));
  }
  void finish() override { file_.finish(); }

 private:
  const StoreInfo& info_;
  OutputFile file_;
  std::size_t rgbAt_ = 0;
};

std::unique_ptr<ScanWriter> createWriter(const std::string& path, const StoreInfo& info) {
  if (path.ends_with(".pcd")) return std::make_unique<PcdWriter>(path, info);
  if (path.ends_with(".las") || path.ends_with(".laz"))
    return createLasWriter(path, info, {info.points, info.bounds}, {path.ends_with(".laz"), {}});
  throw UsageError(path, "unknown format (expected .las, .laz or .pcd)");
}

NodePoints readPart(const PointSource& source, std::size_t part) {
  NodePoints points;
  PointBlock block;
  const auto reader = source.openPart(part);
  while (reader->read(block, std::size_t{1} << 20)) {
    for (const glm::dvec3& p : block.positions)
      for (int axis = 0; axis < 3; ++axis)
        points.grid[axis].push_back(std::llround(p[axis] / source.info().step[axis]));
    points.attributes.insert(points.attributes.end(), block.attributes.begin(), block.attributes.end());
  }
  return points;
}

int run(int argc, char** argv) {
  if (argc < 3) throw UsageError("make_scan", "found too little (expected INPUT OUT.las|OUT.laz|OUT.pcd...)");
  const auto sources = openScans({argv[1]}, {});
  const PointSource& source = *sources.front();
  if (!source.info().gridExact) throw Error(argv[1], "has no grid that LAS could keep");
  const StoreInfo info = describe(source.info());
  std::vector<std::unique_ptr<ScanWriter>> writers;
  for (int i = 2; i < argc; ++i) writers.push_back(createWriter(argv[i], info));
  std::size_t next = 0;
  tbb::parallel_pipeline(
      kPartsAtOnce, tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order,
                                                        [&](tbb::flow_control& flow) {
                                                          if (next == source.partCount()) flow.stop();
                                                          return next++;
                                                        }) &
                        tbb::make_filter<std::size_t, std::shared_ptr<NodePoints>>(
                            tbb::filter_mode::parallel,
                            [&](std::size_t part) { return std::make_shared<NodePoints>(readPart(source, part)); }) &
                        tbb::make_filter<std::shared_ptr<NodePoints>, void>(
                            tbb::filter_mode::serial_in_order, [&](const std::shared_ptr<NodePoints>& points) {
                              for (const auto& writer : writers) writer->write(*points);
                            }));
  for (const auto& writer : writers) writer->finish();
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) { return strata::exitCodeOf(strata::run, argc, argv); }
