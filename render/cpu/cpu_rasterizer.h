#pragma once
#include <memory>

#include "render/rasterizer.h"
#include "render/rasterizer_options.h"

namespace strata {

/// Makes a rasterizer that needs no OpenGL. Threads share the batches, and vector instructions work on the points of a
/// batch. After an early depth test, each thread lowers the packed depth and id of a pixel by compare-and-swap (Schütz
/// 2022, 3.2).
std::unique_ptr<Rasterizer> createCpuRasterizer(const RasterizerOptions& options);

}  // namespace strata
