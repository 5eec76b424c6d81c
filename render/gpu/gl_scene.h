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

  /// The owners of GL objects call this before they destroy them.
  void makeCurrent() const { device_.makeCurrent(); }
  const GlFunctions& gl() const { return device_.gl(); }
  const std::string& renderer() const { return device_.renderer(); }
  std::uint32_t groupSize() const { return device_.groupSize(); }

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
