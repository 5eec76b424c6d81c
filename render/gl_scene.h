#pragma once
#include <memory>
#include <vector>

#include "render/batch_plan.h"
#include "render/gl_objects.h"
#include "render/gpu_node_store.h"
#include "render/rasterizer.h"
#include "render/shaders/shader_types.h"

namespace strata {

/// Batches whose nodes lie in one page; their records are consecutive.
struct PageRun {
  std::uint32_t page = 0;
  std::uint32_t firstRecord = 0;
  std::uint32_t recordCount = 0;
};

/// What the GL rasterizers share: the context and, for each frame, node data and batch records on the GPU.
class GlScene {
 public:
  /// Throws Error where the context has no OpenGL 4.3.
  GlScene(std::unique_ptr<GlContext> context, const RasterizerOptions& options);

  /// Owners of GL objects call it before they destroy them.
  void makeCurrent() { context_->makeCurrent(); }
  const GlFunctions& gl() const { return gl_; }
  const std::string& renderer() const { return renderer_; }

  /// Plans the frame and uploads what it needs within the budgets. Fills all stats but the times of draw and resolve.
  DrawStats prepare(const RenderList& list, const View& view, const DrawOptions& options);
  /// Of the frame that was prepared.
  const std::vector<PageRun>& runs() const { return runs_; }
  const std::vector<shader::BatchRecord>& records() const { return records_; }
  /// Binds records and page for a shader that includes batch.glsl.
  void bind(const PageRun& run) const;
  /// Sets the uniforms of batch.glsl in the program in use.
  void setViewUniforms() const;

 private:
  std::unique_ptr<GlContext> context_;
  GlFunctions gl_;
  std::string renderer_;
  GpuNodeStore nodes_;
  GlBuffer recordBuffer_;
  DrawPlan plan_;
  std::vector<PageRun> runs_;
  std::vector<shader::BatchRecord> records_;
};

}  // namespace strata
