#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/draw_options.h"
#include "core/node_data.h"

namespace strata {

/// Consecutive batches of a node as they lie in one page: their boxes, then their points' planes, classes, colours.
struct NodePart {
  std::uint32_t page = 0;
  std::uint32_t firstBox = 0;  ///< word of the page; a shader::BatchBox each
  std::uint32_t boxCount = 0;
  std::uint32_t firstWord = 0;    ///< plane p of point i is word firstWord + p * planeStride + i - firstPoint
  std::uint32_t planeStride = 0;  ///< a multiple of 4, as firstWord is: four points are one 128-bit load
  std::uint32_t firstPoint = 0;   ///< within the node
  std::uint32_t pointCount = 0;
  std::uint32_t firstClass = 0;   ///< word of the first point's class, a byte each; 0: not there
  std::uint32_t firstColour = 0;  ///< word of the first point's colour; 0: not there
  std::uint32_t candidateWords = 0;
};

struct GpuNode {
  std::vector<NodePart> parts;  ///< by ascending firstPoint
  int planes = 0;
  bool oneGrid = false;         ///< all batches stand on the grid of the first; then:
  glm::dvec3 step{0.0};         ///< metres
  glm::dvec3 lo{0.0}, hi{0.0};  ///< bounds of the boxes in steps from the first batch's corner
};

/// What a frame reads of a node beside its positions.
struct NodeNeeds {
  bool classes = false;
  bool colours = false;  ///< as words of `options`, for a mean of several points
  const DrawOptions* options = nullptr;
  std::uint64_t colourKey = 0;  ///< changes whenever `options` may give another colour
};

/// Splits a node into parts of at most `partBytes` and kMostBoxes batches, each as yet without a page. None where a
/// batch is longer than that.
std::vector<NodePart> splitNode(const NodeData& node, const NodeNeeds& needs, std::uint64_t partBytes,
                                std::uint32_t groupSize);

inline constexpr std::uint32_t kMostBoxes = 65535;  ///< work-groups in one dispatch, which OpenGL guarantees

/// Words of compute32.comp's candidates of a batch whose first point is `pointsBefore` points into its part.
std::uint32_t candidateWords(std::uint32_t pointsBefore, std::uint32_t points, std::uint32_t groupSize);

/// Words that a part takes.
std::uint64_t partWords(const NodePart& part, int planes, const NodeNeeds& needs);

/// Places what a part holds one after the other from `word` on, which is a multiple of 4.
void layOut(NodePart& part, std::uint32_t word, int planes, const NodeNeeds& needs);

/// Whether all batches of a node stand on one grid, and that grid.
void findGrid(const NodeData& node, GpuNode& gpuNode);

/// Everything but the colours; `words` are those of the part, from firstBox on.
void fillPart(const NodeData& node, const GpuNode& gpuNode, const NodePart& part, std::uint32_t groupSize,
              std::span<std::uint32_t> words);

}  // namespace strata
