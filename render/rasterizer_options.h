#pragma once
#include <cstdint>

namespace strata {

/// The memory and the threads that a rasterizer may use.
struct RasterizerOptions {
  int threads = 0;                                  ///< 0: one per core
  std::uint64_t gpuBytes = std::uint64_t{1} << 30;  ///< cap on node data in GPU memory
  std::uint64_t uploadBytesPerFrame = std::uint64_t{64} << 20;
};

}  // namespace strata
