#pragma once
#include <cstdint>

namespace strata {

/// Limits on what a rasterizer may use.
struct RasterizerOptions {
  int threads = 0;                                  ///< cpu; 0 = all cores
  std::uint64_t gpuBytes = std::uint64_t{1} << 30;  ///< cap on node data held by the GPU
  std::uint64_t uploadBytesPerFrame = std::uint64_t{64} << 20;
};

}  // namespace strata
