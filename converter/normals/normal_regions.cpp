#include "converter/normals/normal_regions.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "converter/normals/distinct_cells.h"
#include "converter/normals/nearest_points.h"
#include "converter/normals/plane_fit.h"
#include "io/store/node_codec.h"

namespace strata {
namespace {

constexpr std::size_t kNeighbours = 16;  // the point itself included
/// A neighbour may be four cells away, of the size in which a cell has six points on average.
constexpr double kPointsOfCell = 6.0;
constexpr double kReachInCells = 4.0;

/// A box of grid integers, both ends inside.
struct GridBox {
  std::int64_t low[3], high[3];

  bool contains(const std::int64_t (&grid)[3]) const {
    for (int axis = 0; axis < 3; ++axis)
      if (grid[axis] < low[axis] || grid[axis] > high[axis]) return false;
    return true;
  }
  bool meets(const GridBox& other) const {
    for (int axis = 0; axis < 3; ++axis)
      if (other.high[axis] < low[axis] || other.low[axis] > high[axis]) return false;
    return true;
  }
};

GridBox boxOf(NodeKey key, int cubeBits) {
  GridBox box{};
  const std::int64_t side = std::int64_t{1} << (cubeBits - key.level());
  std::int64_t cell[3] = {0, 0, 0};
  for (int level = key.level() - 1; level >= 0; --level) {
    const std::uint64_t octant = key.code >> (3 * level) & 7;
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = cell[axis] << 1 | static_cast<std::int64_t>(octant >> (2 - axis) & 1);
  }
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = cell[axis] * side;
    box.high[axis] = box.low[axis] + side - 1;
  }
  return box;
}

/// The points that estimateRegion() works on.
struct Gathered {
  std::vector<RegionPoint> own;
  std::vector<glm::dvec3> positions;  ///< metres from grid integer 0: those of `own`, then those around
};

/// Collects the points in and around a region from the nodes of a store.
class Gatherer {
 public:
  Gatherer(const Store& store, const GridBox& region, const GridBox& around, std::uint64_t mostAround)
      : store_(store), region_(region), around_(around), mostAround_(mostAround) {}

  /// False where more points lie around than are allowed.
  bool gather(Gathered& out) {
    visit(0, out);
    if (beyond_.size() > mostAround_) return false;
    out.positions.insert(out.positions.end(), beyond_.begin(), beyond_.end());
    return true;
  }

 private:
  void visit(std::uint32_t node, Gathered& out) {
    const NodeRecord& record = store_.hierarchy().nodes[node];
    if (!around_.meets(boxOf(NodeKey{record.key}, store_.info().cubeBits)) || beyond_.size() > mostAround_) return;
    const NodePoints points = readAll(store_, node);
    for (std::uint32_t i = 0; i < points.count(); ++i) {
      const std::int64_t grid[3] = {points.grid[0][i], points.grid[1][i], points.grid[2][i]};
      if (!around_.contains(grid)) continue;
      const glm::dvec3 position = glm::dvec3(grid[0], grid[1], grid[2]) * store_.info().grid.scale;
      if (region_.contains(grid)) {
        out.own.push_back({node, i});
        out.positions.push_back(position);
      } else {
        beyond_.push_back(position);
      }
    }
    for (int k = 0, child = static_cast<int>(record.firstChild); k < std::popcount(record.childMask); ++k, ++child)
      visit(static_cast<std::uint32_t>(child), out);
  }

  const Store& store_;
  const GridBox region_, around_;
  const std::uint64_t mostAround_;
  std::vector<glm::dvec3> beyond_;
};

GridBox grown(const GridBox& box, double reach, const glm::dvec3& scale) {
  GridBox out = box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto steps = static_cast<std::int64_t>(std::min(std::ceil(reach / scale[axis]), 0x1p53));
    out.low[axis] -= steps;
    out.high[axis] += steps;
  }
  return out;
}

bool before(const glm::dvec3& a, const glm::dvec3& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// Turns the normal to the station's side, or up; where that leaves it open, towards +y and then +x.
glm::dvec3 oriented(const glm::dvec3& normal, const glm::dvec3& position, const std::optional<glm::dvec3>& station) {
  double side = 0.0;
  if (station) side = glm::dot(normal, *station - position);
  for (const int axis : {2, 1, 0})
    if (side == 0.0) side = normal[axis];
  return side < 0.0 ? -normal : normal;
}

}  // namespace

std::vector<NormalRegion> normalRegions(const Hierarchy& hierarchy, std::uint64_t limit) {
  std::vector<std::uint64_t> below(hierarchy.nodes.size());
  for (std::size_t i = hierarchy.nodes.size(); i-- > 0;) {  // children come behind their parents
    const NodeRecord& record = hierarchy.nodes[i];
    below[i] = record.pointCount;
    for (int k = 0; k < std::popcount(record.childMask); ++k)
      below[i] += below[record.firstChild + static_cast<std::size_t>(k)];
  }
  std::vector<NormalRegion> regions;
  const auto split = [&](auto&& self, std::size_t node) -> void {
    const NodeRecord& record = hierarchy.nodes[node];
    if (below[node] <= limit || record.childMask == 0 || record.sliced != 0) {
      regions.push_back({NodeKey{record.key}, true});
      return;
    }
    std::size_t child = record.firstChild;
    for (int octant = 0; octant < 8; ++octant)
      if ((record.childMask >> octant & 1) != 0)
        self(self, child++);
      else
        regions.push_back({NodeKey{record.key}.child(octant), false});  // points of the nodes above may lie there
  };
  split(split, 0);
  return regions;
}

double neighbourReach(const Store& store, const ConvertOptions& options, const ConvertControl& control) {
  const int sizes = store.info().cubeBits + 1;
  tbb::enumerable_thread_specific<DistinctCells> parts([&] { return DistinctCells(sizes); });
  tbb::task_arena arena(options.threads);
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, store.hierarchy().nodes.size(), [&](std::size_t node) {
      control.checkStop();
      DistinctCells& cells = parts.local();
      const NodePoints points = readAll(store, static_cast<std::uint32_t>(node));
      for (std::size_t i = 0; i < points.count(); ++i)
        cells.see({points.grid[0][i], points.grid[1][i], points.grid[2][i]});
    });
  });
  DistinctCells cells(sizes);
  for (const DistinctCells& part : parts) cells.add(part);
  int shift = 0;
  while (shift + 1 < sizes && cells.count(shift) * kPointsOfCell > cells.count(0)) ++shift;
  const glm::dvec3& scale = store.info().grid.scale;
  return kReachInCells * std::ldexp(std::max({scale.x, scale.y, scale.z}), shift);
}

RegionNormals estimateRegion(const Store& store, const NormalRegion& region, double reach, std::uint64_t mostAround,
                             const std::optional<glm::dvec3>& station) {
  const GridBox box = boxOf(region.cell, store.info().cubeBits);
  Gathered all;
  if (!region.hasNode) {  // an empty region needs no look around
    Gatherer(store, box, box, mostAround).gather(all);
    if (all.own.empty()) return {};
    all = {};
  }
  while (!Gatherer(store, box, grown(box, reach, store.info().grid.scale), mostAround).gather(all)) {
    all = {};
    reach *= 0.5;
  }
  RegionNormals out;
  out.points = std::move(all.own);
  if (out.points.empty()) return out;

  // Points in one place are one neighbour, so that copies do not crowd out the others.
  std::vector<std::uint32_t> sorted(all.positions.size());
  std::iota(sorted.begin(), sorted.end(), 0u);
  std::sort(sorted.begin(), sorted.end(),
            [&](std::uint32_t a, std::uint32_t b) { return before(all.positions[a], all.positions[b]); });
  std::vector<glm::dvec3> distinct;
  std::vector<std::uint32_t> indexOf(out.points.size());  // of each own point in `distinct`
  std::vector<bool> wanted;
  for (const std::uint32_t i : sorted) {
    if (distinct.empty() || distinct.back() != all.positions[i]) {
      distinct.push_back(all.positions[i]);
      wanted.push_back(false);
    }
    if (i < indexOf.size()) {
      indexOf[i] = static_cast<std::uint32_t>(distinct.size() - 1);
      wanted.back() = true;
    }
  }
  all = {};
  sorted = {};

  const NearestPoints tree(distinct);
  std::vector<Octahedral> normals(distinct.size(), Octahedral{127, 127});
  std::vector<std::uint32_t> found;
  std::vector<glm::dvec3> neighbours;
  for (const std::uint32_t point : tree.order()) {
    if (!wanted[point]) continue;
    tree.find(point, kNeighbours, reach, found);
    neighbours.clear();
    for (const std::uint32_t f : found) neighbours.push_back(distinct[f]);
    const glm::dvec3 normal = planeNormal(neighbours).value_or(glm::dvec3(0.0, 0.0, 1.0));
    normals[point] = encodeOctahedral(oriented(normal, distinct[point] + store.info().grid.offset, station));
  }
  out.normals.reserve(indexOf.size());
  for (const std::uint32_t point : indexOf) out.normals.push_back(normals[point]);
  return out;
}

}  // namespace strata
