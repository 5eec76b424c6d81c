#pragma once
#include <bitset>
#include <memory>
#include <span>
#include <vector>

#include "render/gl/gl_context.h"
#include "render/gl/gl_device.h"
#include "render/gl/gl_objects.h"
#include "render/gl/shader_variant.h"
#include "render/gpu/gpu_node_store.h"
#include "render/plan/batch_plan.h"
#include "render/rasterizer.h"
#include "render/rasterizer_options.h"
#include "render/shaders/shader_types.h"

namespace strata {

/// Batches that one dispatch draws: their nodes lie in one page, and their records are consecutive.
struct PageRun {
  std::uint32_t page = 0;
  std::uint32_t firstRecord = 0;
  std::uint32_t recordCount = 0;  ///< records that the CPU made; plan.comp appends its own
  std::uint32_t capacity = 0;     ///< the records that the run has room for, at most kMostBoxes
  std::uint32_t firstPart = 0;
  std::uint32_t partCount = 0;
};

/// What compute and points rasterizers share: the device, the nodes in GPU memory, and for each draw the records of the
/// batches. A draw goes prepare(), dispatchPlan(), then dispatch() for each of the runs().
class GlScene {
 public:
  /// Throws Error where the context has no OpenGL 4.3.
  GlScene(std::unique_ptr<GlContext> context, const RasterizerOptions& options);

  /// The owners of GL objects call this before they destroy them.
  void makeCurrent() const { device_.makeCurrent(); }
  const GlFunctions& gl() const { return device_.gl(); }
  const std::string& renderer() const { return device_.renderer(); }
  std::uint32_t groupSize() const { return device_.groupSize(); }

  /// Compiles plan.comp. Throws Error where the driver cannot.
  void compile() { plans_.get({}); }

  /// What prepare() is to do besides uploading nodes.
  struct How {
    bool cullOnGpu = false;  ///< leave batches to dispatchPlan(); else the CPU makes all records
    bool colours = false;    ///< upload the colours of the points
    int forcedPlanes = 0;    ///< ComputeExperiment::forcedPlanes
  };
  /// Decides what is drawn, and uploads it as far as the budgets allow. There are at most STRATA_MOST_VIEWS views, and
  /// only one without cullOnGpu. Without cullOnGpu the stats are complete except for the times; else the counters add
  /// the rest.
  DrawStats prepare(const RenderList& list, std::span<const View> views, const DrawOptions& options, const How& how);
  /// Clears the counters. Then culls batches on the GPU by frustum, prefix and clip region, chooses their precisions
  /// and appends their records.
  void dispatchPlan();
  shader::Counters readCounters() const;

  // The following are about the draw that was prepared last.
  const std::vector<PageRun>& runs() const { return runs_; }
  const std::vector<shader::BatchRecord>& records() const { return records_; }
  std::uint64_t candidateWords() const { return candidateWords_; }
  const ShaderVariant& variant() const { return variant_; }
  bool drawable() const { return drawable_; }
  /// Binds the records and the page of a run for a shader that includes batch.glsl.
  void bind(const PageRun& run) const;
  /// Draws a run with the program in use, one work-group per record.
  void dispatch(const PageRun& run) const;
  void bindCounters() const { counters_.bindStorage(STRATA_BINDING_COUNTERS); }
  /// Sets the uniforms of batch.glsl in the program in use.
  void setViewUniforms() const;

 private:
  struct PreparedDraw;

  void addItem(PreparedDraw& draw, std::uint32_t item, std::uint32_t firstId);
  bool addParts(PreparedDraw& draw, const NodeData& node, const GpuNode& gpuNode, std::uint32_t prefix,
                std::uint32_t firstId);
  void addPlanned(PreparedDraw& draw);
  void layRuns(PreparedDraw& draw);
  void upload(const PreparedDraw& draw);

  const GlDevice device_;
  GpuNodeStore nodes_;
  ProgramCache plans_;
  GlBuffer recordBuffer_, batchViewBuffer_, gridBuffer_, partBuffer_, viewBuffer_, runBuffer_, counters_;
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
