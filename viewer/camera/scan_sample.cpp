#include "viewer/camera/scan_sample.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

#include "io/store/node_codec.h"

namespace strata {
namespace {

constexpr double kTrimmedShare = 0.001;  // of the points beyond either end of an axis that bounds may leave out
constexpr double kTrimMargin = 0.08;     // of the trimmed size, added again on both sides
constexpr double kSlab = 0.15;           // of the height: what counts as floor and as ceiling
constexpr double kEnclosedShare = 0.55;  // of the columns with data that have both

Box robustBounds(std::vector<glm::dvec3>& points) {
  Box whole;
  for (const glm::dvec3& p : points) whole.add(p);
  Box trimmed;
  const std::size_t cut = static_cast<std::size_t>(kTrimmedShare * static_cast<double>(points.size()));
  std::vector<double> values(points.size());
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    std::transform(points.begin(), points.end(), values.begin(), [axis](const glm::dvec3& p) { return p[axis]; });
    const auto low = values.begin() + static_cast<std::ptrdiff_t>(cut);
    const auto high = values.end() - 1 - static_cast<std::ptrdiff_t>(cut);
    std::nth_element(values.begin(), low, values.end());
    trimmed.min[axis] = *low;
    std::nth_element(values.begin(), high, values.end());
    trimmed.max[axis] = *high;
  }
  const glm::dvec3 margin = trimmed.size() * kTrimMargin;
  return {glm::max(whole.min, trimmed.min - margin), glm::min(whole.max, trimmed.max + margin)};
}

/// Points lie on surfaces: with n points in v occupied voxels of edge e, neighbours stand about e sqrt(v / n) apart.
double surfaceSpacing(const ScanSample& scan) {
  const double edge = std::max(scan.diagonal() / 128.0, 1e-9);
  std::unordered_set<std::uint64_t> occupied;
  for (const glm::dvec3& p : scan.points) {
    const glm::dvec3 cell = (p - scan.bounds.min) / edge;
    occupied.insert(static_cast<std::uint64_t>(cell.x) << 40 | static_cast<std::uint64_t>(cell.y) << 20 |
                    static_cast<std::uint64_t>(cell.z));
  }
  return edge * std::sqrt(static_cast<double>(occupied.size()) / static_cast<double>(scan.points.size()));
}

bool isEnclosed(const ScanSample& scan) {
  constexpr int kSide = 24;
  std::vector<int> floorHits(kSide * kSide), ceilingHits(kSide * kSide), hits(kSide * kSide);
  const glm::dvec3 size = glm::max(scan.bounds.size(), glm::dvec3(1e-9));
  if (scan.tallness() < 0.08) return false;
  for (const glm::dvec3& p : scan.points) {
    const glm::dvec3 unit = glm::clamp((p - scan.bounds.min) / size, 0.0, 1.0);
    const std::size_t cell = static_cast<std::size_t>(std::min(kSide - 1, static_cast<int>(unit.y * kSide)) * kSide +
                                                      std::min(kSide - 1, static_cast<int>(unit.x * kSide)));
    ++hits[cell];
    floorHits[cell] += unit.z < kSlab ? 1 : 0;
    ceilingHits[cell] += unit.z > 1.0 - kSlab ? 1 : 0;
  }
  int withData = 0;
  int both = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    withData += hits[i] > 0 ? 1 : 0;
    both += floorHits[i] > 0 && ceilingHits[i] > 0 ? 1 : 0;
  }
  return both > kEnclosedShare * withData && withData > kSide * kSide / 3;
}

/// Appends the first `share` of the node's level order.
void addPrefix(const Store& store, std::uint32_t nodeIndex, double share, std::vector<glm::dvec3>& out) {
  NodeData node;
  readForDrawing(store, nodeIndex, Precision::medium20, node);
  const std::uint32_t wanted =
      std::min(node.pointCount(), static_cast<std::uint32_t>(std::ceil(share * node.pointCount())));
  for (const Batch& batch : node.batches)
    for (std::uint32_t i = 0; i < batch.pointCount && batch.firstPoint + i < wanted; ++i)
      out.push_back(pointPosition(node, batch, batch.firstPoint + i, Precision::medium20));
}

}  // namespace

double ScanSample::tallness() const {
  const glm::dvec3 size = bounds.size();
  return size.z / std::max(std::hypot(size.x, size.y), 1e-9);
}

ScanSample makeScanSample(std::vector<glm::dvec3> points) {
  ScanSample scan;
  if (points.empty()) points = {glm::dvec3(0.0), glm::dvec3(1.0)};
  scan.bounds = robustBounds(points);
  if (scan.diagonal() < 1e-6) {
    scan.bounds.min -= glm::dvec3(0.5);
    scan.bounds.max += glm::dvec3(0.5);
  }
  std::erase_if(points, [&](const glm::dvec3& p) { return !scan.bounds.contains(p); });
  scan.points = std::move(points);
  scan.spacing = surfaceSpacing(scan);
  scan.enclosed = isEnclosed(scan);
  return scan;
}

ScanSample sampleStore(const Store& store) {
  const std::vector<NodeRecord>& nodes = store.hierarchy().nodes;
  std::vector<glm::dvec3> points;
  // Whole levels, so that no region is sampled more densely than another; of the last one a share of every node.
  for (std::size_t first = 0; first < nodes.size() && points.size() < kSampledPoints;) {
    const int level = NodeKey{nodes[first].key}.level();
    std::size_t end = first;
    std::uint64_t inLevel = 0;
    while (end < nodes.size() && NodeKey{nodes[end].key}.level() == level) inLevel += nodes[end++].pointCount;
    const double share = std::min(1.0, static_cast<double>(kSampledPoints - points.size()) /
                                           static_cast<double>(std::max<std::uint64_t>(inLevel, 1)));
    // A share of many thousand nodes would read them all for a few points each.
    if (share < 0.05 && !points.empty()) break;
    for (std::size_t i = first; i < end; ++i) addPrefix(store, static_cast<std::uint32_t>(i), share, points);
    first = end;
  }
  return makeScanSample(std::move(points));
}

LocalNode localNode(const Store& store, const glm::dvec3& place) {
  const std::vector<NodeRecord>& nodes = store.hierarchy().nodes;
  Box cube = store.info().rootCube();
  LocalNode local{0, nodes[0].spacing};
  for (;;) {
    const NodeRecord& node = nodes[local.index];
    const glm::dvec3 middle = cube.centre();
    const int octant = (place.x >= middle.x ? 4 : 0) + (place.y >= middle.y ? 2 : 0) + (place.z >= middle.z ? 1 : 0);
    if (node.firstChild == 0 || node.sliced != 0 || (node.childMask >> octant & 1) == 0) return local;
    int before = 0;
    for (int i = 0; i < octant; ++i) before += node.childMask >> i & 1;
    local.index = node.firstChild + static_cast<std::uint32_t>(before);
    local.spacing = nodes[local.index].spacing;
    for (glm::length_t axis = 0; axis < 3; ++axis)
      (place[axis] >= middle[axis] ? cube.min : cube.max)[axis] = middle[axis];
  }
}

HeightGrid::HeightGrid(const ScanSample& scan) {
  const glm::dvec3 size = scan.bounds.size();
  origin_ = glm::dvec2(scan.bounds.min);
  cell_ = std::max(std::max(size.x, size.y) / kCells, 1e-9);
  columns_ = std::clamp(static_cast<int>(std::ceil(size.x / cell_)), 1, kCells);
  rows_ = std::clamp(static_cast<int>(std::ceil(size.y / cell_)), 1, kCells);
  const std::size_t cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  count_.assign(cells, 0);
  ground_.assign(cells, std::numeric_limits<double>::infinity());
  top_.assign(cells, -std::numeric_limits<double>::infinity());
  for (const glm::dvec3& p : scan.points) {
    const glm::ivec2 cell = cellOf(glm::dvec2(p));
    const std::size_t i = index(cell.x, cell.y);
    ++count_[i];
    ground_[i] = std::min(ground_[i], p.z);
    top_[i] = std::max(top_[i], p.z);
  }
  std::vector<glm::ivec2> filled;
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column)
      if (hasData(column, row)) filled.push_back({column, row});
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      if (hasData(column, row)) continue;
      const auto distance2 = [&](const glm::ivec2& c) {
        return (c.x - column) * (c.x - column) + (c.y - row) * (c.y - row);
      };
      const glm::ivec2 nearest = *std::min_element(
          filled.begin(), filled.end(), [&](const auto& a, const auto& b) { return distance2(a) < distance2(b); });
      ground_[index(column, row)] = ground_[index(nearest.x, nearest.y)];
      top_[index(column, row)] = top_[index(nearest.x, nearest.y)];
    }
}

glm::dvec2 HeightGrid::centre(int column, int row) const {
  return origin_ + glm::dvec2(column + 0.5, row + 0.5) * cell_;
}

glm::ivec2 HeightGrid::cellOf(const glm::dvec2& place) const {
  const glm::dvec2 cell = (place - origin_) / cell_;
  return {static_cast<int>(std::clamp(cell.x, 0.0, columns_ - 1.0)),
          static_cast<int>(std::clamp(cell.y, 0.0, rows_ - 1.0))};
}

}  // namespace strata
