#include "converter/normals/add_normals.h"

#include <fcntl.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cstring>
#include <memory>
#include <numeric>
#include <span>

#include "converter/journal/disk_room.h"
#include "converter/normals/normal_regions.h"
#include "core/error.h"
#include "io/file/byte_source.h"
#include "io/file/output_file.h"
#include "io/file/positional_io.h"
#include "io/store/node_codec.h"
#include "io/store/store_files.h"

namespace strata {
namespace {

constexpr std::uint64_t kMostRegionPoints = 1 << 20;
constexpr std::uint64_t kLeastRegionPoints = 1 << 16;
/// A point of a region takes about as much: its position twice, indices, order, tree, and the points around.
constexpr std::uint64_t kRegionPointBytes = 200;
/// The program takes as much without points.
constexpr std::uint64_t kProgramBytes = std::uint64_t{200} << 20;

/// Two bytes for each point of the store, in a temporary file without a name. Thread-safe.
class CodeFile {
 public:
  explicit CodeFile(const std::string& folder) : folder_(folder) {
    std::string name = folder + "/strata-normals-XXXXXX";
    descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
    if (descriptor_ < 0) throw posixError(folder, "creating a temporary file", errno);
    ::unlink(name.c_str());
  }
  ~CodeFile() { ::close(descriptor_); }
  CodeFile(const CodeFile&) = delete;
  CodeFile& operator=(const CodeFile&) = delete;

  void write(std::uint64_t firstPoint, std::span<const Octahedral> codes) {
    writeAt(descriptor_, folder_, firstPoint * sizeof(Octahedral), std::as_bytes(codes), "temporary normals");
  }
  void read(std::uint64_t firstPoint, std::span<Octahedral> codes) const {
    const std::span<std::byte> bytes = std::as_writable_bytes(codes);
    if (readAt(descriptor_, folder_, firstPoint * sizeof(Octahedral), bytes, "temporary normals") < bytes.size())
      throw Error(folder_, "temporary normals end early");
  }

 private:
  const std::string folder_;
  int descriptor_;
};

/// The normals of all points: in the file for nodes inside one region, in memory for the few nodes above the regions.
class NormalCodes {
 public:
  NormalCodes(const Hierarchy& hierarchy, const std::vector<NormalRegion>& regions, const std::string& folder)
      : file_(folder), first_(hierarchy.nodes.size() + 1), shared_(hierarchy.nodes.size()) {
    for (std::size_t i = 0; i < hierarchy.nodes.size(); ++i) first_[i + 1] = first_[i] + hierarchy.nodes[i].pointCount;
    std::vector<std::uint64_t> above;
    for (const NormalRegion& region : regions)
      for (std::uint64_t code = region.cell.code >> 3; code > 0; code >>= 3) above.push_back(code);
    std::sort(above.begin(), above.end());
    for (std::size_t i = 0; i < hierarchy.nodes.size(); ++i)
      if (std::binary_search(above.begin(), above.end(), hierarchy.nodes[i].key))
        shared_[i].resize(hierarchy.nodes[i].pointCount, Octahedral{127, 127});
  }

  /// Different threads may put different regions at the same time.
  void put(const RegionNormals& region) {
    std::vector<Octahedral> run;
    for (std::size_t i = 0; i < region.points.size();) {
      const std::uint32_t node = region.points[i].node;
      const std::size_t begin = i;
      for (; i < region.points.size() && region.points[i].node == node; ++i)
        if (!shared_[node].empty()) shared_[node][region.points[i].point] = region.normals[i];
      if (!shared_[node].empty()) continue;
      run.assign(region.normals.begin() + static_cast<std::ptrdiff_t>(begin),
                 region.normals.begin() + static_cast<std::ptrdiff_t>(i));
      file_.write(first_[node] + region.points[begin].point, run);  // all points of a node, one after the other
    }
  }
  std::vector<Octahedral> of(std::size_t node) const {
    if (!shared_[node].empty()) return shared_[node];
    std::vector<Octahedral> codes(first_[node + 1] - first_[node]);
    file_.read(first_[node], codes);
    return codes;
  }
  std::uint64_t points() const { return first_.back(); }

 private:
  CodeFile file_;
  std::vector<std::uint64_t> first_;             ///< number of each node's first point
  std::vector<std::vector<Octahedral>> shared_;  ///< by node; empty for nodes inside one region
};

PointLayout withNormals(const PointLayout& layout) {
  std::vector<Attribute> attributes = layout.attributes();
  attributes.push_back({std::string(attribute::kNormalOctahedral), ScalarType::u8, 2, "estimated normal", 1.0, 0.0});
  return PointLayout(std::move(attributes));
}

/// Reads a node and appends the normals to the attribute records of its points.
NodePoints extended(const Store& store, std::uint32_t node, const std::vector<Octahedral>& codes) {
  NodePoints points = readAll(store, node);
  const std::size_t stride = store.info().layout.stride();
  std::vector<std::byte> records(points.count() * (stride + sizeof(Octahedral)));
  std::byte* to = records.data();
  for (std::size_t i = 0; i < points.count(); ++i) {
    to = std::copy_n(points.attributes.data() + i * stride, stride, to);
    std::memcpy(to, codes[i].data(), sizeof(Octahedral));
    to += sizeof(Octahedral);
  }
  points.attributes = std::move(records);
  const NodeRecord& record = store.hierarchy().nodes[node];
  points.levels.assign(record.prefix, record.prefix + record.prefixes);
  if (store.info().layout.find(attribute::kRgb) >= 0) {
    NodeData drawn;
    readForDrawing(store, node, Precision::low10, drawn);
    points.drawColours = std::move(drawn.colour);
    for (std::uint32_t& colour : points.drawColours) colour &= 0xffffffu;
  }
  return points;
}

struct RewrittenNode {
  std::uint32_t node;
  EncodedNode encoded;
};

/// Writes all nodes with their normals to `job.newPath`, in the order in which they lie in the store. `info` has the
/// new layout; `hierarchy` gets the new sizes and offsets.
void rewriteNodes(const NormalsJob& job, const Store& store, const NormalCodes& codes, const StoreInfo& info,
                  Hierarchy& hierarchy) {
  std::vector<std::uint32_t> order(hierarchy.nodes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return store.hierarchy().nodes[a].offset < store.hierarchy().nodes[b].offset;
  });
  OutputFile file(job.newPath);
  const PointsHeader header = pointsHeader();
  file.append(std::as_bytes(std::span(&header, 1)));
  std::size_t next = 0;
  const auto take =
      tbb::make_filter<void, std::uint32_t>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& flow) {
        if (next == order.size()) {
          flow.stop();
          return 0u;
        }
        job.control.checkStop();
        return order[next++];
      });
  const auto rewrite = tbb::make_filter<std::uint32_t, std::shared_ptr<RewrittenNode>>(
      tbb::filter_mode::parallel, [&](std::uint32_t node) {
        return std::make_shared<RewrittenNode>(
            RewrittenNode{node, encodeNode(extended(store, node, codes.of(node)), info)});
      });
  const auto write = tbb::make_filter<std::shared_ptr<RewrittenNode>, void>(
      tbb::filter_mode::serial_in_order, [&](const std::shared_ptr<RewrittenNode>& done) {
        NodeRecord& record = hierarchy.nodes[done->node];
        record.offset = file.size();
        record.headBytes = done->encoded.headBytes;
        record.headChecksum = done->encoded.headChecksum;
        record.payloadBytes = static_cast<std::uint32_t>(done->encoded.payload.size());
        std::copy(done->encoded.drawBytes, done->encoded.drawBytes + 3, record.drawBytes);
        file.append(done->encoded.payload);
      });
  tbb::task_arena arena(job.options.threads);
  arena.execute(
      [&] { tbb::parallel_pipeline(static_cast<std::size_t>(2 * job.options.threads), take & rewrite & write); });
  file.finish();
}

}  // namespace

bool normalsMissing(const StoreInfo& info, const ConvertOptions& options, const ConvertControl& control) {
  if (!options.normals) return false;
  for (const std::string_view name : {attribute::kNormal, attribute::kNormalOctahedral})
    if (info.layout.find(name) >= 0) {
      control.warn(options.output + ": the scan has normals already; they are kept and none are estimated");
      return false;
    }
  return true;
}

std::uint64_t addNormals(const NormalsJob& job, StoreInfo& info, Hierarchy& hierarchy) {
  const ConvertOptions& options = job.options;
  const Store store(info, hierarchy, openFile(job.pointsPath));
  // Few threads with regions of a fair size do better than many with small ones, around which more has to be read.
  const std::uint64_t room =
      (options.memoryBytes - std::min(options.memoryBytes / 2, kProgramBytes)) / kRegionPointBytes;
  const int workers = static_cast<int>(
      std::clamp<std::uint64_t>(room / kLeastRegionPoints, 1, static_cast<std::uint64_t>(options.threads)));
  const std::uint64_t limit =
      std::clamp(room / static_cast<std::uint64_t>(workers) / 2, kLeastRegionPoints / 2, kMostRegionPoints);
  const std::vector<NormalRegion> regions = normalRegions(hierarchy, limit);
  const double reach = neighbourReach(store, options, job.control);

  NormalCodes codes(hierarchy, regions, options.tempFolder.empty() ? folderOf(job.pointsPath) : options.tempFolder);
  std::atomic<std::uint64_t> done{0};
  tbb::task_arena arena(workers);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, regions.size(), 1),
        [&](const auto& range) {
          for (std::size_t i = range.begin(); i != range.end(); ++i) {
            job.control.checkStop();
            const RegionNormals region = estimateRegion(store, regions[i], reach, limit, job.station);
            codes.put(region);
            job.control.progress({stage::kNormals, done += region.points.size(), info.points});
          }
        },
        tbb::simple_partitioner());
  });
  info.layout = withNormals(info.layout);
  info.ranges.push_back({0.0, 254.0, 0.0, 254.0});
  rewriteNodes(job, store, codes, info, hierarchy);
  return codes.points() * sizeof(Octahedral);
}

}  // namespace strata
