#include "render/gpu/node_parts.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "render/plan/grid_transform.h"
#include "render/shaders/shader_types.h"

namespace strata {
namespace {

constexpr std::uint32_t kFours = 8;  ///< fours of points whose candidates share a word, as in compute32.comp

std::uint32_t wholeFours(std::uint32_t count) { return (count + 3) / 4 * 4; }

const Batch* firstBatch(const NodeData& node, const NodePart& part) {
  return &*std::lower_bound(node.batches.begin(), node.batches.end(), part.firstPoint,
                            [](const Batch& batch, std::uint32_t point) { return batch.firstPoint < point; });
}

}  // namespace

std::uint32_t candidateWords(std::uint32_t pointsBefore, std::uint32_t points, std::uint32_t groupSize) {
  const std::uint32_t fours = (pointsBefore % 4 + points + 3) / 4;
  return std::min(fours, groupSize) * ((fours + kFours * groupSize - 1) / (kFours * groupSize));
}

std::uint64_t partWords(const NodePart& part, int planes, const NodeNeeds& needs) {
  const std::uint64_t points = wholeFours(part.pointCount);
  return std::uint64_t{part.boxCount} * STRATA_BOX_WORDS + points * static_cast<std::uint64_t>(planes) +
         (needs.classes ? (points / 4 + 3) / 4 * 4 : 0) + (needs.colours ? points : 0);
}

std::vector<NodePart> splitNode(const NodeData& node, const NodeNeeds& needs, std::uint64_t partBytes,
                                std::uint32_t groupSize) {
  std::vector<NodePart> parts;
  for (const Batch& batch : node.batches) {
    if (!parts.empty()) {
      NodePart longer = parts.back();
      ++longer.boxCount;
      longer.candidateWords += candidateWords(batch.firstPoint - longer.firstPoint, batch.pointCount, groupSize);
      longer.pointCount += batch.pointCount;
      if (longer.boxCount <= kMostBoxes && partWords(longer, node.loadedPlanes(), needs) * 4 <= partBytes) {
        parts.back() = longer;
        continue;
      }
    }
    NodePart& part = parts.emplace_back();
    part.firstPoint = batch.firstPoint;
    part.pointCount = batch.pointCount;
    part.boxCount = 1;
    part.candidateWords = candidateWords(0, batch.pointCount, groupSize);
    if (partWords(part, node.loadedPlanes(), needs) * 4 > partBytes) return {};
  }
  return parts;
}

void layOut(NodePart& part, std::uint32_t word, int planes, const NodeNeeds& needs) {
  part.firstBox = word;
  part.firstWord = word + part.boxCount * STRATA_BOX_WORDS;
  part.planeStride = wholeFours(part.pointCount);
  const std::uint32_t afterPlanes = part.firstWord + part.planeStride * static_cast<std::uint32_t>(planes);
  part.firstClass = needs.classes ? afterPlanes : 0;
  part.firstColour = needs.colours ? afterPlanes + (needs.classes ? (part.planeStride / 4 + 3) / 4 * 4 : 0) : 0;
}

void findGrid(const NodeData& node, GpuNode& gpuNode) {
  if (node.batches.empty()) return;
  const Batch& first = node.batches.front();
  gpuNode.step = first.boxSize / glm::exp2(glm::dvec3(first.bits));
  gpuNode.lo = gpuNode.hi = glm::dvec3(0.0);
  gpuNode.oneGrid = std::min({gpuNode.step.x, gpuNode.step.y, gpuNode.step.z}) > 0.0;
  for (const Batch& batch : node.batches) {
    const glm::dvec3 steps = glm::exp2(glm::dvec3(batch.bits));
    const glm::dvec3 corner = (batch.boxMin - first.boxMin) / gpuNode.step;
    const glm::dvec3 off = glm::abs(corner - glm::round(corner));
    const bool fits = batch.boxSize == gpuNode.step * steps && off.x < GridFinder::kOffGrid &&
                      off.y < GridFinder::kOffGrid && off.z < GridFinder::kOffGrid;
    gpuNode.oneGrid = gpuNode.oneGrid && fits;
    gpuNode.lo = glm::min(gpuNode.lo, corner);
    gpuNode.hi = glm::max(gpuNode.hi, corner + steps);
  }
}

void fillPart(const NodeData& node, const GpuNode& gpuNode, const NodePart& part, std::uint32_t groupSize,
              std::span<std::uint32_t> words) {
  const Batch* batch = firstBatch(node, part);
  std::uint32_t candidate = 0;
  for (std::uint32_t i = 0; i < part.boxCount; ++i, ++batch) {
    shader::BatchBox box{};
    std::memcpy(box.boxMin, &batch->boxMin, sizeof box.boxMin);
    const glm::dvec3 corner =
        gpuNode.oneGrid ? (batch->boxMin - node.batches.front().boxMin) / gpuNode.step : gpuNode.lo;
    for (int axis = 0; axis < 3; ++axis) {
      const double steps = std::round(corner[axis]);
      if (gpuNode.oneGrid && std::abs(steps) < 2147483647.0) box.step[axis] = static_cast<int>(steps);
    }
    box.bits = batch->bits.x | static_cast<std::uint32_t>(batch->bits.y) << 8 |
               static_cast<std::uint32_t>(batch->bits.z) << 16;
    box.firstPoint = batch->firstPoint;
    box.pointCount = batch->pointCount;
    box.firstCandidate = candidate;
    candidate += candidateWords(batch->firstPoint - part.firstPoint, batch->pointCount, groupSize);
    std::memcpy(&words[std::size_t{i} * STRATA_BOX_WORDS], &box, sizeof box);
  }
  for (int p = 0; p < gpuNode.planes; ++p) {
    const std::size_t at = part.firstWord - part.firstBox + std::size_t{part.planeStride} * static_cast<std::size_t>(p);
    std::memcpy(&words[at], &node.position[p][part.firstPoint], std::size_t{part.pointCount} * 4);
  }
  if (part.firstClass != 0 && !node.classification.empty())
    std::memcpy(&words[part.firstClass - part.firstBox], &node.classification[part.firstPoint], part.pointCount);
}

}  // namespace strata
