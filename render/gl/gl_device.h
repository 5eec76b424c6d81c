#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "render/gl/gl_context.h"
#include "render/gl/gl_functions.h"

namespace strata {

/// A context that a rasterizer draws with, its functions, and what is known about the OpenGL behind it. Objects that
/// are made with gl() must not outlive the device.
class GlDevice {
 public:
  /// Takes over `context` and makes it current. Throws Error where it is null or has no OpenGL 4.3.
  explicit GlDevice(std::unique_ptr<GlContext> context);
  GlDevice(const GlDevice&) = delete;
  GlDevice& operator=(const GlDevice&) = delete;

  void makeCurrent() const { context_->makeCurrent(); }
  const GlFunctions& gl() const { return gl_; }
  /// The device and its driver, see glRenderer().
  const std::string& renderer() const { return renderer_; }
  /// True where OpenGL runs on the CPU.
  bool isSoftware() const { return software_; }
  /// Threads of a work-group that draws points: 128 on a GPU (Schütz 2022, 3.2). Mesa's llvmpipe runs the threads of a
  /// group one vector after the other, each through all of the group's points, so there a group is one vector.
  std::uint32_t groupSize() const { return software_ ? 8 : 128; }

 private:
  const std::unique_ptr<GlContext> context_;
  const GlFunctions gl_;
  const std::string renderer_;
  const bool software_;
};

}  // namespace strata
