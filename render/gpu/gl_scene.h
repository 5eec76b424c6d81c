#pragma once
#include <bitset>
#include <memory>
#include <span>
#include <vector>

#include "render/gl/gl_context.h"
#include "render/gl/gl_objects.h"
#include "render/gl/shader_variant.h"
#include "render/gpu/gpu_node_store.h"
#include "render/plan/batch_plan.h"
#include "render/rasterizer.h"
#include "render/rasterizer_options.h"
#include "render/shaders/shader_types.h"

namespace strata {

/// As shaders read it.
shader::GridRecord gridRecord(const GridTransform& grid);
/// Numbers of boxes, planes, cutouts, as shaders read them.
glm::ivec3 clipCounts(const Clip& clip);

/// Batches whose nodes lie in one page; their records are consecutive.
struct PageRun {
  std::uint32_t page = 0;
  std::uint32_t firstRecord = 0;
  std::uint32_t recordCount = 0;  ///< made by the CPU; plan.comp appends to them
  std::uint32_t capacity = 0;     ///< of records, at most kMostBoxes
  std::uint32_t firstPart = 0;
  std::uint32_t partCount = 0;
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
  /// Threads of a work-group that draws one batch: Schütz's 128 on a GPU. Mesa's llvmpipe runs the threads of a group
  /// one vector after the other, each through the whole batch, so there a group is one vector.
  std::uint32_t groupSize() const { return software_ ? 8 : 128; }

  /// Compiles plan.comp. Throws Error where the driver cannot.
  void compile() { plans_.get({}); }

  struct How {
    bool cullOnGpu = false;  ///< by dispatchPlan(); else all records are the CPU's
    bool colours = false;    ///< upload the points' colours
    int forcedPlanes = 0;    ///< experiments: planes to read, and nothing is culled; 0: neither
  };
  /// Decides what is drawn and uploads what it needs within the budgets. At most STRATA_MOST_VIEWS views, one with the
  /// CPU's records. Without cullOnGpu the stats are whole but for the times.
  DrawStats prepare(const RenderList& list, std::span<const View> views, const DrawOptions& options, const How& how);
  /// Culls on the GPU: frustum, prefix and clip region; chooses precisions, appends records. Clears the counters.
  void dispatchPlan();
  shader::Counters readCounters() const;

  /// Of the frame that was prepared.
  const std::vector<PageRun>& runs() const { return runs_; }
  const std::vector<shader::BatchRecord>& records() const { return records_; }
  std::uint64_t candidateWords() const { return candidateWords_; }
  const ShaderVariant& variant() const { return variant_; }
  bool drawable() const { return drawable_; }
  /// Binds records and page for a shader that includes batch.glsl.
  void bind(const PageRun& run) const;
  void dispatch(const PageRun& run) const;
  void bindCounters() const { counters_.bindStorage(STRATA_BINDING_COUNTERS); }
  /// Sets the uniforms of batch.glsl in the program in use.
  void setViewUniforms() const;

 private:
  struct PreparedDraw;

  void addItem(PreparedDraw& frame, std::uint32_t item, std::uint32_t firstId);
  bool addParts(PreparedDraw& frame, const NodeData& node, const GpuNode& place, std::uint32_t prefix,
                std::uint32_t firstId);
  void addPlanned(PreparedDraw& frame);
  void layRuns(PreparedDraw& frame);
  void upload(const PreparedDraw& frame);

  std::unique_ptr<GlContext> context_;
  GlFunctions gl_;
  std::string renderer_;
  const bool software_;
  GpuNodeStore nodes_;
  ProgramCache plans_;
  GlBuffer recordBuffer_, placeBuffer_, gridBuffer_, partBuffer_, viewBuffer_, runBuffer_, counters_;
  ShaderVariant variant_;
  std::vector<ViewConstants> constants_;
  std::bitset<256> classes_;
  glm::ivec3 clips_{0};  ///< numbers of boxes, planes, cutouts
  int forcedPlanes_ = 0;
  bool drawable_ = false;
  std::vector<PageRun> runs_;
  std::vector<shader::BatchRecord> records_;
  std::uint64_t candidateWords_ = 0;
};

}  // namespace strata
