#include "render/gpu/node_parts.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "render/shaders/shader_types.h"

namespace strata {
namespace {

constexpr std::uint32_t kFours = 8;  ///< of points, whose candidates are one word; as in compute32.comp
constexpr double kOffGrid = 1e-4;    ///< steps that a corner may be off and still be on the grid: doubles round

std::uint32_t wholeFours(std::uint32_t count) { return (count + 3) / 4 * 4; }

const Batch* firstBatch(const NodeData& node, const GpuPart& part) {
  return &*std::lower_bound(node.batches.begin(), node.batches.end(), part.firstPoint,
                            [](const Batch& batch, std::uint32_t point) { return batch.firstPoint < point; });
}

}  // namespace

std::uint32_t candidateWords(std::uint32_t pointsBefore, std::uint32_t points, std::uint32_t groupSize) {
  const std::uint32_t fours = (pointsBefore % 4 + points + 3) / 4;
  return std::min(fours, groupSize) * ((fours + kFours * groupSize - 1) / (kFours * groupSize));
}

std::uint64_t partWords(const GpuPart& part, int planes, const NodeNeeds& needs) {
  const std::uint64_t points = wholeFours(part.pointCount);
  return std::uint64_t{part.boxCount} * STRATA_BOX_WORDS + points * static_cast<std::uint64_t>(planes) +
         (needs.classes ? (points / 4 + 3) / 4 * 4 : 0) + (needs.colours ? points : 0);
}

std::vector<GpuPart> splitNode(const NodeData& node, const NodeNeeds& needs, std::uint64_t partBytes,
                               std::uint32_t groupSize) {
  std::vector<GpuPart> parts;
  for (const Batch& batch : node.batches) {
    if (!parts.empty()) {
      GpuPart longer = parts.back();
      ++longer.boxCount;
      longer.candidateWords += candidateWords(batch.firstPoint - longer.firstPoint, batch.pointCount, groupSize);
      longer.pointCount += batch.pointCount;
      if (longer.boxCount <= kMostBoxes && partWords(longer, node.loadedPlanes(), needs) * 4 <= partBytes) {
        parts.back() = longer;
        continue;
      }
    }
    GpuPart& part = parts.emplace_back();
    part.firstPoint = batch.firstPoint;
    part.pointCount = batch.pointCount;
    part.boxCount = 1;
    part.candidateWords = candidateWords(0, batch.pointCount, groupSize);
    if (partWords(part, node.loadedPlanes(), needs) * 4 > partBytes) return {};
  }
  return parts;
}

void layOut(GpuPart& part, std::uint32_t word, int planes, const NodeNeeds& needs) {
  part.firstBox = word;
  part.firstWord = word + part.boxCount * STRATA_BOX_WORDS;
  part.planeStride = wholeFours(part.pointCount);
  const std::uint32_t afterPlanes = part.firstWord + part.planeStride * static_cast<std::uint32_t>(planes);
  part.firstClass = needs.classes ? afterPlanes : 0;
  part.firstColour = needs.colours ? afterPlanes + (needs.classes ? (part.planeStride / 4 + 3) / 4 * 4 : 0) : 0;
}

void findGrid(const NodeData& node, GpuNode& place) {
  if (node.batches.empty()) return;
  const Batch& first = node.batches.front();
  place.step = first.boxSize / glm::exp2(glm::dvec3(first.bits));
  place.lo = place.hi = glm::dvec3(0.0);
  place.oneGrid = std::min({place.step.x, place.step.y, place.step.z}) > 0.0;
  for (const Batch& batch : node.batches) {
    const glm::dvec3 steps = glm::exp2(glm::dvec3(batch.bits));
    const glm::dvec3 corner = (batch.boxMin - first.boxMin) / place.step;
    const glm::dvec3 off = glm::abs(corner - glm::round(corner));
    const bool fits = batch.boxSize == place.step * steps && off.x < kOffGrid && off.y < kOffGrid && off.z < kOffGrid;
    place.oneGrid = place.oneGrid && fits;
    place.lo = glm::min(place.lo, corner);
    place.hi = glm::max(place.hi, corner + steps);
  }
}

void fillPart(const NodeData& node, const GpuNode& place, const GpuPart& part, std::uint32_t groupSize,
              std::span<std::uint32_t> words) {
  const Batch* batch = firstBatch(node, part);
  std::uint32_t candidate = 0;
  for (std::uint32_t i = 0; i < part.boxCount; ++i, ++batch) {
    shader::BatchBox box{};
    std::memcpy(box.boxMin, &batch->boxMin, sizeof box.boxMin);
    const glm::dvec3 corner = place.oneGrid ? (batch->boxMin - node.batches.front().boxMin) / place.step : place.lo;
    for (int axis = 0; axis < 3; ++axis) {
      const double steps = std::round(corner[axis]);
      if (place.oneGrid && std::abs(steps) < 2147483647.0) box.step[axis] = static_cast<int>(steps);
    }
    box.bits = batch->bits.x | static_cast<std::uint32_t>(batch->bits.y) << 8 |
               static_cast<std::uint32_t>(batch->bits.z) << 16;
    box.firstPoint = batch->firstPoint;
    box.pointCount = batch->pointCount;
    box.firstCandidate = candidate;
    candidate += candidateWords(batch->firstPoint - part.firstPoint, batch->pointCount, groupSize);
    std::memcpy(&words[std::size_t{i} * STRATA_BOX_WORDS], &box, sizeof box);
  }
  for (int p = 0; p < place.planes; ++p) {
    const std::size_t at = part.firstWord - part.firstBox + std::size_t{part.planeStride} * static_cast<std::size_t>(p);
    std::memcpy(&words[at], &node.position[p][part.firstPoint], std::size_t{part.pointCount} * 4);
  }
  if (part.firstClass != 0 && !node.classification.empty())
    std::memcpy(&words[part.firstClass - part.firstBox], &node.classification[part.firstPoint], part.pointCount);
}

}  // namespace strata
