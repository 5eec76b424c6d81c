#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "core/frame.h"
#include "core/render_list.h"
#include "render/gl_context.h"

namespace strata {

/// What one draw did and what it cost.
struct DrawStats {
  std::uint64_t pointsDrawn = 0;  ///< sent through projection, after culling
  std::uint32_t batchesDrawn = 0;
  std::uint32_t batchesCulled = 0;         ///< outside the frustum
  std::uint32_t batchesAt[3] = {0, 0, 0};  ///< by precision: 10, 20, 30 bits
  std::uint32_t nodesNotUploaded = 0;      ///< left out of this frame: over the upload budget or out of GPU memory
  std::uint64_t bytesUploaded = 0;
  std::uint64_t gpuBytes = 0;  ///< held by node data on the GPU; 0 for cpu
  double uploadMs = 0.0, drawMs = 0.0, resolveMs = 0.0;
};

/// Turns a RenderList into pixels. One thread uses it: the render thread, which owns the GL context if there is one.
/// All implementations give the picture of the oracle (tests/support/oracle.h): for each pixel the point with the
/// smallest depth (compared as 32-bit float; ties go to the lower id) wins. Drawing does not throw.
class Rasterizer {
 public:
  virtual ~Rasterizer() = default;
  /// Draws `list` as seen by `view` (which may be newer than the list's). `frame` is resized to the view.
  virtual DrawStats draw(const RenderList& list, const View& view, const DrawOptions& options, Frame& frame) = 0;
  virtual std::string_view name() const = 0;
  /// "llvmpipe (LLVM 15.0.6, 256 bits)", "2 threads"; for reports.
  virtual std::string device() const = 0;
};

enum class Backend : std::uint8_t { automatic, cpu, compute32, points };

/// "auto", "cpu", "compute32", "points". Throws UsageError, naming the choices, for anything else.
Backend parseBackend(std::string_view name);

struct RasterizerOptions {
  int threads = 0;                                  ///< cpu; 0 = all cores
  std::uint64_t gpuBytes = std::uint64_t{1} << 30;  ///< cap on node data held by the GPU
  std::uint64_t uploadBytesPerFrame = std::uint64_t{64} << 20;
};

/// Takes over `context`; null will do for cpu, which lets go of one it is given. `automatic` is cpu where there is no
/// context or OpenGL runs on the CPU or lacks what compute32 needs, else compute32. Throws Error where the backend
/// cannot work with the context.
std::unique_ptr<Rasterizer> createRasterizer(Backend backend, const RasterizerOptions& options,
                                             std::unique_ptr<GlContext> context);

}  // namespace strata
