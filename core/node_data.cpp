#include "core/node_data.h"

#include <cmath>

namespace strata {

std::uint64_t NodeData::bytes() const {
  std::uint64_t total = sizeof(NodeData) + batches.capacity() * sizeof(Batch);
  for (const auto& plane : position) total += plane.capacity() * sizeof(std::uint32_t);
  return total + colour.capacity() * sizeof(std::uint32_t) + intensity.capacity() * sizeof(std::uint16_t) +
         classification.capacity() + returnNumber.capacity() + normal.capacity() * sizeof(std::uint32_t);
}

std::uint32_t packNormal(const glm::vec3& normal) {
  const float length = glm::length(normal);
  if (!(length > 0.0f) || !std::isfinite(length)) return 0;
  const glm::vec3 unit = glm::round(normal / length * 127.0f);
  const auto byte = [](float value) { return static_cast<std::uint32_t>(static_cast<int>(value)) & 255u; };
  return byte(unit.x) | byte(unit.y) << 8 | byte(unit.z) << 16;
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
