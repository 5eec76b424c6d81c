#include "render/gpu/gl_scene.h"

#include <algorithm>

#include "core/fingerprint.h"
#include "render/gpu/node_parts.h"
#include "render/gpu/shader_records.h"
#include "render/plan/grid_transform.h"

namespace strata {
namespace {

constexpr std::uint32_t kPlanSize = 32;  ///< threads that plan one part on a GPU

std::vector<ShaderStage> planStages(bool software) {
  return {{gl::kComputeShader,
           {"shader_types.h", "plan.comp"},
           define("STRATA_PLAN_SIZE", std::to_string(software ? 8 : kPlanSize)) +
               define("STRATA_PX_AT_10_BITS", std::to_string(kPixelsAt10Bits) + "LF") +
               define("STRATA_PX_AT_20_BITS", std::to_string(kPixelsAt20Bits) + "LF")}};
}

/// A fingerprint of all options that pointColour() reads.
std::uint64_t colourKey(const DrawOptions& options) {
  Fingerprint key;
  key.add(options.colour);
  if (options.colour == ColourMode::intensity) key.add(options.intensityRange);
  if (options.colour == ColourMode::elevation) key.add(options.elevationRange);
  return key.value();
}

std::uint32_t batchesBefore(const NodeData& node, std::uint32_t prefix) {
  const auto end = std::partition_point(node.batches.begin(), node.batches.end(),
                                        [prefix](const Batch& batch) { return batch.firstPoint < prefix; });
  return static_cast<std::uint32_t>(end - node.batches.begin());
}

bool seen(const ViewConstants& c, const NodeData& node) {
  if (!c.drawable || node.batches.empty()) return false;
  Box box;
  for (const Batch& batch : node.batches) {
    box.add(batch.boxMin);
    box.add(batch.boxMin + batch.boxSize);
  }
  const glm::dvec3 origin = node.origin - c.view.eye;
  return boxInFrustum(c.planes, origin + box.min, origin + box.max);
}

}  // namespace

/// A draw while it is prepared.
struct GlScene::PreparedDraw {
  struct PerPage {
    std::vector<shader::DrawPart> parts;
    std::vector<shader::BatchRecord> records;
    std::vector<shader::BatchView> batchViews;  ///< views() for each record
  };

  const RenderList& list;
  const DrawOptions& options;
  const How& how;
  NodeNeeds needs;
  std::vector<std::vector<GridTransform>> grids{};  ///< of each view, then of each plan of the CPU
  std::vector<GridFinder> finders{};
  RenderList odd{};  ///< items that the CPU plans. The others have no node but keep their count, so that ids stay
  std::vector<const GpuNode*> oddNodes{};
  std::vector<PerPage> pages{};
  std::vector<shader::DrawPart> parts{};
  std::vector<shader::BatchView> batchViews{};
  DrawStats stats{};

  PerPage& page(std::uint32_t index) {
    if (index >= pages.size()) pages.resize(index + 1);
    return pages[index];
  }
};

GlScene::GlScene(std::unique_ptr<GlContext> context, const RasterizerOptions& options)
    : device_(std::move(context)),
      nodes_(gl(), options.gpuBytes, options.uploadBytesPerFrame, groupSize()),
      plans_(gl(), planStages(device_.isSoftware())),
      recordBuffer_(gl(), 0, gl::kDynamicCopy),
      batchViewBuffer_(gl(), 0, gl::kDynamicCopy),
      gridBuffer_(gl(), 0, gl::kStreamDraw),
      partBuffer_(gl(), 0, gl::kStreamDraw),
      viewBuffer_(gl(), 0, gl::kStreamDraw),
      runBuffer_(gl(), 0, gl::kDynamicCopy),
      counters_(gl(), sizeof(shader::Counters), gl::kDynamicCopy) {}

DrawStats GlScene::prepare(const RenderList& list, std::span<const View> views, const DrawOptions& options,
                           const How& how) {
  PreparedDraw draw{list, options, how, {}};
  constants_.clear();
  for (const View& view : views) constants_.push_back(viewConstants(view));
  drawable_ = std::any_of(constants_.begin(), constants_.end(), [](const ViewConstants& c) { return c.drawable; });
  variant_ = {static_cast<int>(views.size()), !options.clip.empty(), !options.classes.all()};
  classes_ = options.classes;
  clips_ = clipCounts(options.clip);
  forcedPlanes_ = how.forcedPlanes;
  draw.needs = {variant_.classes, how.colours, &options, colourKey(options)};
  draw.grids.resize(views.size());
  for (std::size_t v = 0; v < views.size(); ++v) draw.finders.emplace_back(constants_[v], options.clip, draw.grids[v]);
  nodes_.beginFrame(list);
  std::uint32_t firstId = 0;
  if (drawable_)
    for (std::uint32_t i = 0; i < list.items.size(); firstId += list.items[i++].pointCount) addItem(draw, i, firstId);
  addPlanned(draw);
  layRuns(draw);
  upload(draw);
  draw.stats.bytesUploaded = nodes_.uploadedBytes();
  draw.stats.gpuBytes = nodes_.gpuBytes();
  return draw.stats;
}

/// Uploads the node of an item if a view may see it. Leaves its batches to plan.comp where all lie on one grid, else to
/// addPlanned().
void GlScene::addItem(PreparedDraw& draw, std::uint32_t item, std::uint32_t firstId) {
  const std::shared_ptr<const NodeData>& node = draw.list.items[item].node;
  draw.odd.items.push_back({nullptr, draw.list.items[item].pointCount});
  draw.oddNodes.push_back(nullptr);
  if (node == nullptr) return;
  const std::uint32_t prefix = std::min(draw.list.items[item].pointCount, node->pointCount());
  if (prefix == 0) return;
  const bool anySees =
      std::any_of(constants_.begin(), constants_.end(), [&](const ViewConstants& c) { return seen(c, *node); });
  if (!anySees && draw.how.forcedPlanes == 0) {
    draw.stats.batchesCulled += batchesBefore(*node, prefix) * static_cast<std::uint32_t>(constants_.size());
    return;
  }
  const GpuNode* gpuNode = nodes_.require(node, draw.needs);
  if (gpuNode == nullptr) {
    ++draw.stats.nodesNotUploaded;
    return;
  }
  if (draw.how.cullOnGpu && gpuNode->oneGrid && addParts(draw, *node, *gpuNode, prefix, firstId)) return;
  draw.odd.items.back().node = node;
  draw.oddNodes.back() = gpuNode;
}

/// Adds the parts of a node for plan.comp. False where 32 bits of grid steps do not reach from an eye to all of the
/// node.
bool GlScene::addParts(PreparedDraw& draw, const NodeData& node, const GpuNode& gpuNode, std::uint32_t prefix,
                       std::uint32_t firstId) {
  shader::DrawPart common{};
  common.origin = glm::dvec4(node.origin, 0.0);
  common.step = glm::dvec4(gpuNode.step, 0.0);
  common.prefix = prefix;
  common.firstId = firstId;
  common.planes = static_cast<std::uint32_t>(gpuNode.planes);
  for (std::size_t v = 0; v < constants_.size(); ++v) {
    common.first[v].w = -1;
    if (!constants_[v].drawable || !gazeKeeps(constants_[v], draw.options.gaze, node)) continue;
    const auto grid = draw.finders[v].gridOf(gpuNode.step, node.origin + node.batches.front().boxMin);
    if (!grid) return false;
    const glm::dvec3 farthest = glm::max(glm::abs(grid->first + gpuNode.lo), glm::abs(grid->first + gpuNode.hi));
    if (!(std::max({farthest.x, farthest.y, farthest.z}) < GridFinder::kLargestOffset)) return false;
    common.first[v] = glm::ivec4(glm::ivec3(grid->first), static_cast<int>(grid->index));
  }
  for (const NodePart& part : gpuNode.parts) {
    if (part.firstPoint >= prefix) break;
    shader::DrawPart out = common;
    out.firstBox = part.firstBox;
    out.boxCount = part.boxCount;
    out.firstWord = part.firstWord;
    out.planeStride = part.planeStride;
    out.firstPoint = part.firstPoint;
    out.firstClass = variant_.classes && !node.classification.empty() ? part.firstClass : 0;
    out.firstColour = part.firstColour;
    out.firstCandidate = part.candidateWords;  // becomes the first word in layRuns()
    draw.page(part.page).parts.push_back(out);
  }
  return true;
}

/// Plans the batches that are left to the CPU, and adds one record for each view that sees a batch.
void GlScene::addPlanned(PreparedDraw& draw) {
  const bool none = std::all_of(draw.oddNodes.begin(), draw.oddNodes.end(),
                                [](const GpuNode* gpuNode) { return gpuNode == nullptr; });
  for (std::size_t v = 0; v < constants_.size() && !none; ++v) {
    DrawPlan plan;
    planBatches(draw.odd, constants_[v].view, draw.options, plan);
    std::size_t firstGrid = 0;
    for (const auto& grids : draw.grids) firstGrid += grids.size();
    draw.grids.push_back(plan.grids);
    for (const PlannedBatch& batch : plan.batches) {
      const std::vector<NodePart>& parts = draw.oddNodes[batch.item]->parts;
      const NodePart& part =
          *std::prev(std::upper_bound(parts.begin(), parts.end(), batch.firstPoint,
                                      [](std::uint32_t point, const NodePart& p) { return point < p.firstPoint; }));
      const std::uint32_t ahead = batch.firstPoint - part.firstPoint;
      shader::BatchRecord record{};
      record.firstWord = part.firstWord + ahead;
      record.planeStride = part.planeStride;
      record.pointCount = batch.pointCount;
      record.firstId = batch.firstId;
      record.firstClass = part.firstClass == 0 || batch.node->classification.empty() ? 0 : part.firstClass + ahead / 4;
      record.firstColour = part.firstColour == 0 ? 0 : part.firstColour + ahead;
      record.firstCandidate = strata::candidateWords(ahead, batch.pointCount, groupSize());
      PreparedDraw::PerPage& page = draw.page(part.page);
      page.records.push_back(record);
      page.batchViews.resize(page.batchViews.size() + constants_.size(), {glm::ivec4(0), glm::ivec4(0)});
      shader::BatchView& seenHere = page.batchViews[page.batchViews.size() - constants_.size() + v];
      seenHere.offset = glm::ivec4(batch.mapping.offset, static_cast<int>(batch.precision));
      const int grid = static_cast<int>(firstGrid + batch.mapping.grid);
      seenHere.shift = glm::ivec4(batch.mapping.shift, 2 * grid + (batch.clipped ? STRATA_CLIPPED : 0));
    }
    draw.stats.pointsDrawn += plan.pointCount;
    draw.stats.batchesDrawn += static_cast<std::uint32_t>(plan.batches.size());
    draw.stats.batchesCulled += plan.batchesCulled;
    for (int p = 0; p < 3; ++p) draw.stats.batchesAt[p] += plan.batchesAt[p];
  }
}

/// Arranges the records of each page as one run, or as several where one dispatch cannot hold its batches. A run has
/// the CPU's records first, then room for those that plan.comp appends.
void GlScene::layRuns(PreparedDraw& draw) {
  runs_.clear();
  records_.clear();
  candidateWords_ = 0;
  for (std::uint32_t page = 0; page < draw.pages.size(); ++page) {
    PreparedDraw::PerPage& here = draw.pages[page];
    const auto open = [&] {
      const auto firstRecord = runs_.empty() ? 0u : runs_.back().firstRecord + runs_.back().capacity;
      runs_.push_back({page, firstRecord, 0, 0, static_cast<std::uint32_t>(draw.parts.size()), 0});
      records_.resize(firstRecord);
      draw.batchViews.resize(std::size_t{firstRecord} * constants_.size());
    };
    if (!here.parts.empty() || !here.records.empty()) open();
    for (std::size_t i = 0; i < here.records.size(); ++i) {
      if (runs_.back().capacity == kMostBoxes) open();
      const std::uint32_t words = here.records[i].firstCandidate;
      here.records[i].firstCandidate = static_cast<std::uint32_t>(candidateWords_);
      candidateWords_ += words;
      records_.push_back(here.records[i]);
      const auto from = here.batchViews.begin() + static_cast<std::ptrdiff_t>(i * constants_.size());
      draw.batchViews.insert(draw.batchViews.end(), from, from + static_cast<std::ptrdiff_t>(constants_.size()));
      ++runs_.back().recordCount;
      ++runs_.back().capacity;
    }
    for (shader::DrawPart& part : here.parts) {
      // Indices of grids so far count from the view's own first grid; on the GPU all grids lie in one array.
      for (std::size_t v = 0, firstGrid = 0; v < constants_.size(); firstGrid += draw.grids[v++].size())
        if (part.first[v].w >= 0) part.first[v].w += static_cast<int>(firstGrid);
      if (runs_.back().capacity + part.boxCount > kMostBoxes) open();
      const std::uint32_t words = part.firstCandidate;
      part.firstCandidate = static_cast<std::uint32_t>(candidateWords_);
      candidateWords_ += words;
      part.run = static_cast<std::uint32_t>(runs_.size() - 1);
      part.firstRecord = runs_.back().firstRecord;
      draw.parts.push_back(part);
      ++runs_.back().partCount;
      runs_.back().capacity += part.boxCount;
    }
  }
}

void GlScene::upload(const PreparedDraw& draw) {
  const std::size_t views = std::max<std::size_t>(constants_.size(), 1);
  const std::size_t capacity = runs_.empty() ? 0 : runs_.back().firstRecord + runs_.back().capacity;
  recordBuffer_.reserve(capacity * sizeof(shader::BatchRecord));
  batchViewBuffer_.reserve(capacity * views * sizeof(shader::BatchView));
  if (!records_.empty()) {
    recordBuffer_.write(0, records_.data(), records_.size() * sizeof(shader::BatchRecord));
    batchViewBuffer_.write(0, draw.batchViews.data(), draw.batchViews.size() * sizeof(shader::BatchView));
  }
  std::vector<shader::GridRecord> grids;
  for (const auto& ofView : draw.grids)
    for (const GridTransform& grid : ofView) grids.push_back(gridRecord(grid));
  std::vector<shader::ViewRecord> viewRecords;
  for (const ViewConstants& c : constants_) viewRecords.push_back(viewRecord(c, draw.options.clip));
  std::vector<shader::DispatchRecord> dispatches;
  for (const PageRun& run : runs_) dispatches.push_back({run.recordCount, 1, 1});
  if (!grids.empty()) gridBuffer_.assign(grids.data(), grids.size() * sizeof(shader::GridRecord));
  if (!viewRecords.empty()) viewBuffer_.assign(viewRecords.data(), viewRecords.size() * sizeof(shader::ViewRecord));
  if (!dispatches.empty()) runBuffer_.assign(dispatches.data(), dispatches.size() * sizeof(shader::DispatchRecord));
  if (!draw.parts.empty()) partBuffer_.assign(draw.parts.data(), draw.parts.size() * sizeof(shader::DrawPart));
}

void GlScene::dispatchPlan() {
  counters_.fill(0);
  const bool none = std::all_of(runs_.begin(), runs_.end(), [](const PageRun& run) { return run.partCount == 0; });
  if (none) return;
  plans_.get(ShaderVariant{variant_.views, false, false}).use();
  recordBuffer_.bindStorage(STRATA_BINDING_RECORDS);
  batchViewBuffer_.bindStorage(STRATA_BINDING_BATCH_VIEWS);
  partBuffer_.bindStorage(STRATA_BINDING_PARTS);
  viewBuffer_.bindStorage(STRATA_BINDING_VIEWS);
  runBuffer_.bindStorage(STRATA_BINDING_RUNS);
  bindCounters();
  gl().Uniform3i(STRATA_UNIFORM_CLIPS, clips_.x, clips_.y, clips_.z);
  gl().Uniform1i(STRATA_UNIFORM_FORCED, forcedPlanes_);
  for (const PageRun& run : runs_) {
    if (run.partCount == 0) continue;
    nodes_.bindPage(run.page);
    gl().Uniform1ui(STRATA_UNIFORM_FIRST_PART, run.firstPart);
    gl().DispatchCompute(run.partCount, 1, 1);
  }
  gl().MemoryBarrier(gl::kShaderStorageBarrier | gl::kCommandBarrier | gl::kBufferUpdateBarrier);
}

shader::Counters GlScene::readCounters() const {
  shader::Counters counters{};
  counters_.read(0, &counters, sizeof counters);
  return counters;
}

void GlScene::bind(const PageRun& run) const {
  nodes_.bindPage(run.page);
  recordBuffer_.bindStorage(STRATA_BINDING_RECORDS);
  batchViewBuffer_.bindStorage(STRATA_BINDING_BATCH_VIEWS);
  gridBuffer_.bindStorage(STRATA_BINDING_GRIDS);
}

/// The number of work-groups is read from runBuffer_, because plan.comp has counted the records.
void GlScene::dispatch(const PageRun& run) const {
  bind(run);
  gl().Uniform1ui(STRATA_UNIFORM_FIRST_RECORD, run.firstRecord);
  gl().BindBuffer(gl::kDispatchIndirectBuffer, runBuffer_.name());
  gl().DispatchComputeIndirect(static_cast<std::ptrdiff_t>(&run - runs_.data()) *
                               static_cast<std::ptrdiff_t>(sizeof(shader::DispatchRecord)));
}

void GlScene::setViewUniforms() const {
  strata::setViewUniforms(gl(), constants_);
  setClipUniforms(gl(), clips_);
  if (variant_.classes) setClassUniforms(gl(), classes_);
}

}  // namespace strata
