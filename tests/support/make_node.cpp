#include "tests/support/make_node.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace strata {
namespace {

using Cells = glm::i64vec3;

/// Bounds and 30-bit coordinates of points [first, first + count) as the store makes them.
Batch addBatch(NodeData& node, const std::vector<Cells>& cells, std::uint32_t first, std::uint32_t count, double step) {
  Batch batch;
  batch.firstPoint = first;
  batch.pointCount = count;
  Cells lo = cells[first], hi = lo;
  for (std::uint32_t i = first; i < first + count; ++i) {
    lo = glm::min(lo, cells[i]);
    hi = glm::max(hi, cells[i]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const auto extent = static_cast<std::uint64_t>(hi[axis] - lo[axis]);
    const int bits = static_cast<int>(std::bit_width(extent));
    batch.bits[axis] = static_cast<std::uint8_t>(bits);
    batch.boxMin[axis] = static_cast<double>(lo[axis]) * step;
    batch.boxSize[axis] = std::ldexp(step, bits);
    for (std::uint32_t i = first; i < first + count; ++i) {
      const auto offset = static_cast<std::uint64_t>(cells[i][axis] - lo[axis]);
      const std::uint64_t x30 = bits <= 30 ? offset << (30 - bits) : offset >> (bits - 30);
      for (int p = 0; p < 3; ++p)
        node.position[p][i] |= static_cast<std::uint32_t>(x30 >> (20 - 10 * p) & 1023u) << (10 * axis);
    }
  }
  return batch;
}

}  // namespace

std::shared_ptr<NodeData> makeNodeOf(NodeKey key, std::span<const glm::dvec3> points, double step,
                                     std::uint32_t batchPoints, int planes) {
  auto node = std::make_shared<NodeData>();
  node->key = key;
  const auto count = static_cast<std::uint32_t>(points.size());
  if (count > 0) node->origin = glm::floor(points.front() / step) * step;
  std::vector<Cells> cells;
  cells.reserve(count);
  for (const glm::dvec3& p : points) cells.push_back(Cells(glm::round((p - node->origin) / step)));
  for (auto& plane : node->position) plane.assign(count, 0);
  int bits = 0;
  for (std::uint32_t first = 0; first < count; first += batchPoints) {
    node->batches.push_back(addBatch(*node, cells, first, std::min(batchPoints, count - first), step));
    for (int axis = 0; axis < 3; ++axis) bits = std::max(bits, int{node->batches.back().bits[axis]});
  }
  const int kept = planes > 0 ? planes : std::clamp((bits + 9) / 10, 1, 3);
  for (int p = kept; p < 3; ++p) node->position[p] = {};
  return node;
}

}  // namespace strata
