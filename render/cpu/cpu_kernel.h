#pragma once
#include <cstddef>
#include <cstdint>

#include "render/picture/visibility.h"
#include "render/plan/batch_plan.h"

namespace strata {

/// A batch as one view sees it.
struct KernelView {
  glm::vec4 x, y, depth;                ///< rows of the batch's grid
  glm::ivec3 offset, shift;             ///< GridMapping
  bool inside = false;                  ///< PlannedBatch::inside
  const GridTransform* clip = nullptr;  ///< whose clip region is to be tested; null: none
  Viewport port;
  const PackedPixel* pixels = nullptr;  ///< what is drawn already, for the depth tests
};

/// Consecutive points of a batch, at most ProjectedBlock::kPoints.
struct KernelPoints {
  const std::uint32_t* planes[3] = {};  ///< as many as `precision` needs
  Precision precision = Precision::low10;
  std::size_t count = 0;
  std::uint32_t firstId = 0;
  const std::uint32_t* keep = nullptr;  ///< one a point: 0 leaves it out, all ones draws it; null: all drawn
};

/// Which of the points in the image are wanted.
enum class Wanted : std::uint8_t {
  all,
  front,  ///< not behind the pixel's point (Schütz 2022, Listing 1: the early depth test)
  near    ///< at most kBlendDepth behind it
};

/// The wanted points of a block, in the order they came.
struct ProjectedBlock {
  static constexpr std::size_t kPoints = 512;  ///< a block's input and output stay in the first-level cache
  static constexpr std::size_t kPadding = 64;  ///< lanes that a vector store may write past the last point

  std::size_t count = 0;
  std::uint32_t pixel[kPoints + kPadding];
  std::uint32_t depthBits[kPoints + kPadding];
  std::uint32_t id[kPoints + kPadding];
};

/// Projects a block of points into `viewCount` (1 or 2) views: blocks[v] is what views[v] wants. Points are read and
/// unpacked once (Schütz 2022, 3.6). Uses the best instruction set of the machine.
void projectPoints(const KernelPoints& points, const KernelView* views, int viewCount, Wanted wanted,
                   ProjectedBlock* blocks);

/// Lowers each of `into` to that of `from`, which becomes empty.
void mergePixels(PackedPixel* into, PackedPixel* from, std::size_t count);

/// "AVX3", "AVX2", ...: the instruction set that projectPoints uses here.
const char* kernelTarget();

}  // namespace strata
