#pragma once
#include <cstddef>
#include <cstdint>

#include "render/batch_plan.h"

namespace strata {

/// Points of one block that fall into the image, in the order they came.
struct ProjectedBlock {
  static constexpr std::size_t kPoints = 512;  ///< a block's input and output stay in the first-level cache
  static constexpr std::size_t kPadding = 64;  ///< lanes that a vector store may write past the last point

  std::uint32_t pixel[kPoints + kPadding];
  std::uint32_t depthBits[kPoints + kPadding];
  std::uint32_t id[kPoints + kPadding];
};

/// Where the points of a batch go: its rows and how its coordinates become grid steps.
struct BatchTransform {
  glm::vec4 x, y, depth;
  glm::ivec3 offset, shift;
};

/// Projects `count` points, at most ProjectedBlock::kPoints. `planes[p]` are the words of plane p, for as many planes
/// as `precision` needs. Returns how many points were written. Uses the best instruction set of the machine.
std::size_t projectPoints(const BatchTransform& transform, const Viewport& viewport,
                          const std::uint32_t* const planes[3], Precision precision, std::size_t count,
                          std::uint32_t firstId, ProjectedBlock& out);

/// "AVX3", "AVX2", ...: the instruction set that projectPoints uses here.
const char* kernelTarget();

}  // namespace strata
