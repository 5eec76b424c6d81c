#include "render/gl_scene.h"

#include <algorithm>

#include "core/error.h"

namespace strata {
namespace {

std::unique_ptr<GlContext> currentOrThrow(std::unique_ptr<GlContext> context) {
  if (context == nullptr) throw Error("OpenGL", "this way of drawing needs a context, found none");
  context->makeCurrent();
  return context;
}

shader::BatchRecord makeRecord(const DrawPlan& plan, const PlannedBatch& batch, const GpuNode& place) {
  shader::BatchRecord record;
  const GridTransform& grid = plan.grids[batch.place.grid];
  record.x = grid.x;
  record.y = grid.y;
  record.depth = grid.depth;
  record.offset = glm::ivec4(batch.place.offset, static_cast<int>(batch.precision));
  record.shift = glm::ivec4(batch.place.shift, 0);
  record.firstWord = place.firstWord + batch.firstPoint;
  record.planeStride = place.planeStride;
  record.pointCount = batch.pointCount;
  record.firstId = batch.firstId;
  return record;
}

}  // namespace

GlScene::GlScene(std::unique_ptr<GlContext> context, const RasterizerOptions& options)
    : context_(currentOrThrow(std::move(context))),
      gl_(loadGlFunctions(*context_)),
      renderer_(glRenderer(gl_)),
      nodes_(gl_, options.gpuBytes, options.uploadBytesPerFrame),
      recordBuffer_(gl_, 0, gl::kStreamDraw) {}

DrawStats GlScene::prepare(const RenderList& list, const View& view, const DrawOptions& options) {
  planBatches(list, view, options, plan_);
  nodes_.beginFrame(list);
  DrawStats stats = planStats(plan_);
  stats.pointsDrawn = 0;
  stats.batchesDrawn = 0;
  std::fill(std::begin(stats.batchesAt), std::end(stats.batchesAt), 0u);

  std::vector<std::vector<shader::BatchRecord>> byPage;
  for (std::size_t i = 0; i < plan_.batches.size();) {
    const std::uint32_t item = plan_.batches[i].item;
    const std::optional<GpuNode> place = nodes_.require(list.items[item].node);
    if (!place) ++stats.nodesNotUploaded;
    if (place && place->page >= byPage.size()) byPage.resize(place->page + 1);
    for (; i < plan_.batches.size() && plan_.batches[i].item == item; ++i) {
      if (!place) continue;
      const PlannedBatch& batch = plan_.batches[i];
      byPage[place->page].push_back(makeRecord(plan_, batch, *place));
      stats.pointsDrawn += batch.pointCount;
      ++stats.batchesDrawn;
      ++stats.batchesAt[static_cast<int>(batch.precision) - 1];
    }
  }
  runs_.clear();
  records_.clear();
  for (std::uint32_t page = 0; page < byPage.size(); ++page) {
    if (byPage[page].empty()) continue;
    runs_.push_back(
        {page, static_cast<std::uint32_t>(records_.size()), static_cast<std::uint32_t>(byPage[page].size())});
    records_.insert(records_.end(), byPage[page].begin(), byPage[page].end());
  }
  if (!records_.empty()) recordBuffer_.assign(records_.data(), records_.size() * sizeof(shader::BatchRecord));
  stats.bytesUploaded = nodes_.uploadedBytes();
  stats.gpuBytes = nodes_.gpuBytes();
  return stats;
}

void GlScene::bind(const PageRun& run) const {
  nodes_.bindPage(run.page);
  recordBuffer_.bindStorage(STRATA_BINDING_RECORDS);
}

void GlScene::setViewUniforms() const {
  const strata::Viewport port = viewport(plan_.constants);
  gl_.Uniform4f(STRATA_UNIFORM_VIEWPORT, port.halfWidth, port.halfHeight, port.width, port.height);
  gl_.Uniform2f(STRATA_UNIFORM_LENS, port.nearDepth, port.perspective ? 1.0f : 0.0f);
}

}  // namespace strata
