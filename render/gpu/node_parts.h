#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/draw_options.h"
#include "core/node_data.h"

namespace strata {

/// Consecutive batches of a node that lie in one page of GPU memory: their boxes, then the planes, classes and colours
/// of their points. Offsets count 32-bit words from the beginning of the page.
struct NodePart {
  std::uint32_t page = 0;
  std::uint32_t firstBox = 0;  ///< word of the first shader::BatchBox, one per batch
  std::uint32_t boxCount = 0;
  std::uint32_t firstWord = 0;    ///< plane p of point i has the word firstWord + p * planeStride + i - firstPoint
  std::uint32_t planeStride = 0;  ///< a multiple of 4 like firstWord, so that one 128-bit load takes four points
  std::uint32_t firstPoint = 0;   ///< within the node
  std::uint32_t pointCount = 0;
  std::uint32_t firstClass = 0;      ///< word of the first point's class; classes are bytes. 0: there are none
  std::uint32_t firstColour = 0;     ///< word of the first point's colour. 0: there are none
  std::uint32_t candidateWords = 0;  ///< what compute32.comp needs for all batches
};

/// A node in GPU memory.
struct GpuNode {
  std::vector<NodePart> parts;  ///< by ascending firstPoint
  int planes = 0;
  bool oneGrid = false;         ///< all batches lie on the grid of the first; if so:
  glm::dvec3 step{0.0};         ///< metres
  glm::dvec3 lo{0.0}, hi{0.0};  ///< bounds of the boxes in steps from the first batch's corner
};

/// The attributes of a node that a draw reads besides positions.
struct NodeNeeds {
  bool classes = false;
  bool colours = false;  ///< the points' colours by `options`, for the mean colour of a pixel
  const DrawOptions* options = nullptr;
  std::uint64_t colourKey = 0;  ///< differs where `options` may give other colours
};

/// Splits a node into parts of at most `partBytes` bytes and kMostBoxes batches, which have no page yet. Returns no
/// part at all where a single batch is larger than that.
std::vector<NodePart> splitNode(const NodeData& node, const NodeNeeds& needs, std::uint64_t partBytes,
                                std::uint32_t groupSize);

inline constexpr std::uint32_t kMostBoxes = 65535;  ///< the work-groups that OpenGL guarantees in one dispatch

/// The words of candidates that compute32.comp needs for a batch, whose first point is number `pointsBefore` of its
/// part.
std::uint32_t candidateWords(std::uint32_t pointsBefore, std::uint32_t points, std::uint32_t groupSize);

/// The words that a part takes in its page.
std::uint64_t partWords(const NodePart& part, int planes, const NodeNeeds& needs);

/// Sets the offsets of a part that begins at `word`, a multiple of 4.
void layOut(NodePart& part, std::uint32_t word, int planes, const NodeNeeds& needs);

/// Sets GpuNode::oneGrid and what depends on it.
void findGrid(const NodeData& node, GpuNode& gpuNode);

/// Writes a part, except for its colours, to `words`, which begin with the word firstBox.
void fillPart(const NodeData& node, const GpuNode& gpuNode, const NodePart& part, std::uint32_t groupSize,
              std::span<std::uint32_t> words);

}  // namespace strata
