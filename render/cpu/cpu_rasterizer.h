#pragma once
#include <memory>

#include "render/rasterizer.h"
#include "render/rasterizer_options.h"

namespace strata {

/// Draws on the CPU with no GL at all: threads over batches, vectors over the points of a batch, and a framebuffer
/// of packed depth and id that each thread lowers by compare-and-swap after an early depth test (Schütz 2022, 3.2).
std::unique_ptr<Rasterizer> createCpuRasterizer(const RasterizerOptions& options);

}  // namespace strata
