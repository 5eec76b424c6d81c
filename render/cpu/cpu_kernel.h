#pragma once
#include <cstddef>
#include <cstdint>

#include "render/picture/visibility.h"
#include "render/plan/batch_plan.h"

namespace strata {

/// A batch as one view sees it.
struct KernelView {
  glm::vec4 x, y, depth;                ///< rows of the batch's grid
  glm::ivec3 offset, shift;             ///< of its GridMapping
  bool inside = false;                  ///< PlannedBatch::inside
  const GridTransform* clip = nullptr;  ///< the grid whose clip region the points are tested against; null: no test
  Viewport port;
  const PackedPixel* pixels = nullptr;  ///< drawn so far, for the depth tests
};

/// Consecutive points of a batch, at most ProjectedBlock::kPoints.
struct KernelPoints {
  const std::uint32_t* planes[3] = {};  ///< position words; `precision` says how many planes are read
  Precision precision = Precision::low10;
  std::size_t count = 0;
  std::uint32_t firstId = 0;
  const std::uint32_t* keep = nullptr;  ///< one word per point: 0 leaves it out, all ones keeps it; null keeps all
};

/// Which of the points that lie in the image a block keeps.
enum class Wanted : std::uint8_t {
  all,
  front,  ///< those not behind the pixel's point (the early depth test of Schütz 2022, Listing 1)
  near    ///< those at most kBlendDepth behind it
};

/// The points that a block keeps, in their order.
struct ProjectedBlock {
  static constexpr std::size_t kPoints = 512;  ///< so few that a block's input and output stay in the first-level cache
  static constexpr std::size_t kPadding = 64;  ///< words that a vector store may write behind the last point

  std::size_t count = 0;
  std::uint32_t pixel[kPoints + kPadding];
  std::uint32_t depthBits[kPoints + kPadding];
  std::uint32_t id[kPoints + kPadding];
};

/// Projects a block of points into one or two views, `viewCount` of them: blocks[v] gets the points that views[v]
/// keeps. Points are read and unpacked once (Schütz 2022, 3.6). Runs on the best instruction set of the machine.
void projectPoints(const KernelPoints& points, const KernelView* views, int viewCount, Wanted wanted,
                   ProjectedBlock* blocks);

/// Lowers each of `count` pixels of `into` to that of `from`, and empties `from`.
void mergePixels(PackedPixel* into, PackedPixel* from, std::size_t count);

/// The name of the instruction set that projectPoints() uses here: "AVX3", "AVX2", ...
const char* kernelTarget();

}  // namespace strata
