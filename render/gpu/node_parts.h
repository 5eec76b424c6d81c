#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "render/gpu/gpu_node_store.h"

namespace strata {

/// Splits a node into parts of at most `partBytes` and kMostBoxes batches, each as yet without a page. None where a
/// batch is longer than that.
std::vector<GpuPart> splitNode(const NodeData& node, const NodeNeeds& needs, std::uint64_t partBytes,
                               std::uint32_t groupSize);

inline constexpr std::uint32_t kMostBoxes = 65535;  ///< work-groups in one dispatch, which OpenGL guarantees

/// Words of compute32.comp's candidates of a batch whose first point is `pointsBefore` points into its part.
std::uint32_t candidateWords(std::uint32_t pointsBefore, std::uint32_t points, std::uint32_t groupSize);

/// Words that a part takes.
std::uint64_t partWords(const GpuPart& part, int planes, const NodeNeeds& needs);

/// Places what a part holds one after the other from `word` on, which is a multiple of 4.
void layOut(GpuPart& part, std::uint32_t word, int planes, const NodeNeeds& needs);

/// Whether all batches of a node stand on one grid, and that grid.
void findGrid(const NodeData& node, GpuNode& place);

/// Everything but the colours; `words` are those of the part, from firstBox on.
void fillPart(const NodeData& node, const GpuNode& place, const GpuPart& part, std::uint32_t groupSize,
              std::span<std::uint32_t> words);

}  // namespace strata
