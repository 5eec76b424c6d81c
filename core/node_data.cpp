#include "core/node_data.h"

namespace strata {

std::uint64_t NodeData::bytes() const {
  std::uint64_t total = sizeof(NodeData) + batches.capacity() * sizeof(Batch);
  for (const auto& plane : position) total += plane.capacity() * sizeof(std::uint32_t);
  return total + colour.capacity() * sizeof(std::uint32_t) + intensity.capacity() * sizeof(std::uint16_t) +
         classification.capacity();
}

glm::dvec3 pointPosition(const NodeData& node, const Batch& batch, std::uint32_t point, Precision precision) {
  const int planes = static_cast<int>(precision);
  glm::dvec3 result = node.origin;
  for (int axis = 0; axis < 3; ++axis) {
    std::uint32_t coordinate = 0;
    for (int p = 0; p < planes; ++p) coordinate = coordinate << 10 | (node.position[p][point] >> (10 * axis) & 1023u);
    const double half = batch.bits[axis] > 10 * planes ? 0.5 : 0.0;
    const double cell = batch.boxSize[axis] / static_cast<double>(1u << (10 * planes));
    result[axis] += batch.boxMin[axis] + (coordinate + half) * cell;
  }
  return result;
}

}  // namespace strata
