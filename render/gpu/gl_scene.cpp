#include "render/gpu/gl_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "core/error.h"
#include "render/gpu/node_parts.h"
#include "render/plan/grid_transform.h"

namespace strata {
namespace {

constexpr double kLargestOffset = 2.147e9;  ///< grid steps, as in grid_transform.cpp
constexpr std::uint32_t kPlanSize = 32;     ///< threads that plan one part; 8 where OpenGL runs on the CPU

std::unique_ptr<GlContext> currentOrThrow(std::unique_ptr<GlContext> context) {
  if (context == nullptr) throw Error("OpenGL", "this way of drawing needs a context, found none");
  context->makeCurrent();
  return context;
}

std::vector<ShaderStage> planStages(bool software) {
  return {{gl::kComputeShader,
           {"shader_types.h", "plan.comp"},
           define("STRATA_PLAN_SIZE", std::to_string(software ? 8 : kPlanSize)) +
               define("STRATA_PX_AT_10_BITS", std::to_string(kPixelsAt10Bits) + "LF") +
               define("STRATA_PX_AT_20_BITS", std::to_string(kPixelsAt20Bits) + "LF")}};
}

glm::dvec4 wide(const glm::dvec3& v) { return {v, 0.0}; }

/// Boxes and behind them cutouts, with their places in the shader's arrays.
template <typename Boxes, typename Visit>
void forEachClipBox(const Boxes& boxes, const Boxes& cutouts, Visit visit) {
  std::size_t place = 0;
  for (const Boxes& some : {std::cref(boxes), std::cref(cutouts)})
    for (const auto& box : some)
      if (place < Clip::kMost) visit(place++, box);
}

shader::ViewRecord viewRecord(const ViewConstants& c, const Clip& clip) {
  shader::ViewRecord record{};
  std::copy(c.planes.begin(), c.planes.end(), record.planes);
  record.eye = wide(c.view.eye);
  record.forward = c.projection.rowDepth;
  record.size = {c.pixelsPerMetre, c.cornerStretch, c.view.nearPlane, c.view.orthographic ? 0.0 : 1.0};
  forEachClipBox(clip.boxes, clip.cutouts, [&](std::size_t i, const Box& box) {
    record.clipLo[i] = wide(box.min - c.view.eye);
    record.clipHi[i] = wide(box.max - c.view.eye);
  });
  for (std::size_t i = 0; i < std::min(clip.planes.size(), Clip::kMost); ++i)
    record.clipPlanes[i] =
        glm::dvec4(glm::dvec3(clip.planes[i]), glm::dot(clip.planes[i], glm::dvec4(c.view.eye, 1.0)));
  return record;
}

/// FNV-1a of what pointColour() reads of the options.
std::uint64_t colourKey(const DrawOptions& options) {
  std::uint64_t key = 0xcbf29ce484222325u;
  const auto mix = [&key](const auto& value) {
    for (const std::byte byte : std::as_bytes(std::span(&value, 1)))
      key = (key ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3u;
  };
  mix(options.colour);
  if (options.colour == ColourMode::intensity) mix(options.intensityRange);
  if (options.colour == ColourMode::elevation) mix(options.elevationRange);
  return key;
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

glm::ivec3 clipCounts(const Clip& clip) {
  const std::size_t boxes = std::min(clip.boxes.size(), Clip::kMost);
  return glm::ivec3(
      glm::uvec3(boxes, std::min(clip.planes.size(), Clip::kMost), std::min(clip.cutouts.size(), Clip::kMost - boxes)));
}

shader::GridRecord gridRecord(const GridTransform& grid) {
  shader::GridRecord record{};
  record.x = grid.x;
  record.y = grid.y;
  record.depth = grid.depth;
  forEachClipBox(grid.clipBoxes, grid.clipCutouts, [&](std::size_t i, const ClipSteps& box) {
    record.clipLo[i] = glm::vec4(box.lo, 0.0f);
    record.clipHi[i] = glm::vec4(box.hi, 0.0f);
  });
  for (std::size_t i = 0; i < std::min(grid.clipPlanes.size(), Clip::kMost); ++i)
    record.clipPlanes[i] = grid.clipPlanes[i];
  return record;
}

/// One frame in the making.
struct GlScene::PreparedDraw {
  struct PerPage {
    std::vector<shader::DrawPart> parts;
    std::vector<shader::BatchRecord> records;
    std::vector<shader::BatchPlace> places;  ///< views() for each record
  };

  const RenderList& list;
  const DrawOptions& options;
  const How& how;
  NodeNeeds needs;
  std::vector<std::vector<GridTransform>> grids{};  ///< per view, then those of the CPU's plans
  std::vector<GridFinder> finders{};
  RenderList odd{};  ///< items that the CPU plans; the others keep their count, so that ids stay
  std::vector<const GpuNode*> oddPlaces{};
  std::vector<PerPage> pages{};
  std::vector<shader::DrawPart> parts{};
  std::vector<shader::BatchPlace> places{};
  DrawStats stats{};

  PerPage& page(std::uint32_t index) {
    if (index >= pages.size()) pages.resize(index + 1);
    return pages[index];
  }
};

GlScene::GlScene(std::unique_ptr<GlContext> context, const RasterizerOptions& options)
    : context_(currentOrThrow(std::move(context))),
      gl_(loadGlFunctions(*context_)),
      renderer_(glRenderer(gl_)),
      software_(isSoftwareRenderer(renderer_)),
      nodes_(gl_, options.gpuBytes, options.uploadBytesPerFrame, groupSize()),
      plans_(gl_, planStages(software_)),
      recordBuffer_(gl_, 0, gl::kDynamicCopy),
      placeBuffer_(gl_, 0, gl::kDynamicCopy),
      gridBuffer_(gl_, 0, gl::kStreamDraw),
      partBuffer_(gl_, 0, gl::kStreamDraw),
      viewBuffer_(gl_, 0, gl::kStreamDraw),
      runBuffer_(gl_, 0, gl::kDynamicCopy),
      counters_(gl_, sizeof(shader::Counters), gl::kDynamicCopy) {}

DrawStats GlScene::prepare(const RenderList& list, std::span<const View> views, const DrawOptions& options,
                           const How& how) {
  PreparedDraw frame{list, options, how, {}};
  constants_.clear();
  for (const View& view : views) constants_.push_back(viewConstants(view));
  drawable_ = std::any_of(constants_.begin(), constants_.end(), [](const ViewConstants& c) { return c.drawable; });
  variant_ = {static_cast<int>(views.size()), !options.clip.empty(), !options.classes.all()};
  classes_ = options.classes;
  clips_ = clipCounts(options.clip);
  forcedPlanes_ = how.forcedPlanes;
  frame.needs = {variant_.classes, how.colours, &options, colourKey(options)};
  frame.grids.resize(views.size());
  for (std::size_t v = 0; v < views.size(); ++v)
    frame.finders.emplace_back(constants_[v], options.clip, frame.grids[v]);
  nodes_.beginFrame(list);
  std::uint32_t firstId = 0;
  if (drawable_)
    for (std::uint32_t i = 0; i < list.items.size(); firstId += list.items[i++].pointCount) addItem(frame, i, firstId);
  addPlanned(frame);
  layRuns(frame);
  upload(frame);
  frame.stats.bytesUploaded = nodes_.uploadedBytes();
  frame.stats.gpuBytes = nodes_.gpuBytes();
  return frame.stats;
}

/// Uploads the node where a view may see it, and leaves its batches to plan.comp or to the CPU.
void GlScene::addItem(PreparedDraw& frame, std::uint32_t item, std::uint32_t firstId) {
  const std::shared_ptr<const NodeData>& node = frame.list.items[item].node;
  frame.odd.items.push_back({nullptr, frame.list.items[item].pointCount});
  frame.oddPlaces.push_back(nullptr);
  if (node == nullptr) return;
  const std::uint32_t prefix = std::min(frame.list.items[item].pointCount, node->pointCount());
  if (prefix == 0) return;
  const bool anySees =
      std::any_of(constants_.begin(), constants_.end(), [&](const ViewConstants& c) { return seen(c, *node); });
  if (!anySees && frame.how.forcedPlanes == 0) {
    frame.stats.batchesCulled += batchesBefore(*node, prefix) * static_cast<std::uint32_t>(constants_.size());
    return;
  }
  const GpuNode* place = nodes_.require(node, frame.needs);
  if (place == nullptr) {
    ++frame.stats.nodesNotUploaded;
    return;
  }
  if (frame.how.cullOnGpu && place->oneGrid && addParts(frame, *node, *place, prefix, firstId)) return;
  frame.odd.items.back().node = node;
  frame.oddPlaces.back() = place;
}

/// False where 32 bits of grid steps do not reach from an eye to all of the node.
bool GlScene::addParts(PreparedDraw& frame, const NodeData& node, const GpuNode& place, std::uint32_t prefix,
                       std::uint32_t firstId) {
  shader::DrawPart common{};
  common.origin = wide(node.origin);
  common.step = wide(place.step);
  common.prefix = prefix;
  common.firstId = firstId;
  common.planes = static_cast<std::uint32_t>(place.planes);
  for (std::size_t v = 0; v < constants_.size(); ++v) {
    common.first[v].w = -1;
    if (!constants_[v].drawable || !gazeKeeps(constants_[v], frame.options.gaze, node)) continue;
    const auto grid = frame.finders[v].gridOf(place.step, node.origin + node.batches.front().boxMin);
    if (!grid) return false;
    const glm::dvec3 farthest = glm::max(glm::abs(grid->first + place.lo), glm::abs(grid->first + place.hi));
    if (!(std::max({farthest.x, farthest.y, farthest.z}) < kLargestOffset)) return false;
    common.first[v] = glm::ivec4(glm::ivec3(grid->first), static_cast<int>(grid->index));
  }
  for (const GpuPart& part : place.parts) {
    if (part.firstPoint >= prefix) break;
    shader::DrawPart draw = common;
    draw.firstBox = part.firstBox;
    draw.boxCount = part.boxCount;
    draw.firstWord = part.firstWord;
    draw.planeStride = part.planeStride;
    draw.firstPoint = part.firstPoint;
    draw.firstClass = variant_.classes && !node.classification.empty() ? part.firstClass : 0;
    draw.firstColour = part.firstColour;
    draw.firstCandidate = part.candidateWords;  // becomes the first word in layRuns()
    frame.page(part.page).parts.push_back(draw);
  }
  return true;
}

/// Batches that the CPU plans: one record for each view that sees them.
void GlScene::addPlanned(PreparedDraw& frame) {
  const bool none = std::all_of(frame.oddPlaces.begin(), frame.oddPlaces.end(),
                                [](const GpuNode* place) { return place == nullptr; });
  for (std::size_t v = 0; v < constants_.size() && !none; ++v) {
    DrawPlan plan;
    planBatches(frame.odd, constants_[v].view, frame.options, plan);
    std::size_t firstGrid = 0;
    for (const auto& grids : frame.grids) firstGrid += grids.size();
    frame.grids.push_back(plan.grids);
    for (const PlannedBatch& batch : plan.batches) {
      const std::vector<GpuPart>& parts = frame.oddPlaces[batch.item]->parts;
      const GpuPart& part =
          *std::prev(std::upper_bound(parts.begin(), parts.end(), batch.firstPoint,
                                      [](std::uint32_t point, const GpuPart& p) { return point < p.firstPoint; }));
      const std::uint32_t ahead = batch.firstPoint - part.firstPoint;
      shader::BatchRecord record{};
      record.firstWord = part.firstWord + ahead;
      record.planeStride = part.planeStride;
      record.pointCount = batch.pointCount;
      record.firstId = batch.firstId;
      record.firstClass = part.firstClass == 0 || batch.node->classification.empty() ? 0 : part.firstClass + ahead / 4;
      record.firstColour = part.firstColour == 0 ? 0 : part.firstColour + ahead;
      record.firstCandidate = strata::candidateWords(ahead, batch.pointCount, groupSize());
      PreparedDraw::PerPage& page = frame.page(part.page);
      page.records.push_back(record);
      page.places.resize(page.places.size() + constants_.size(), {glm::ivec4(0), glm::ivec4(0)});
      shader::BatchPlace& seenHere = page.places[page.places.size() - constants_.size() + v];
      seenHere.offset = glm::ivec4(batch.place.offset, static_cast<int>(batch.precision));
      const int grid = static_cast<int>(firstGrid + batch.place.grid);
      seenHere.shift = glm::ivec4(batch.place.shift, 2 * grid + (batch.clipped ? STRATA_CLIPPED : 0));
    }
    frame.stats.pointsDrawn += plan.pointCount;
    frame.stats.batchesDrawn += static_cast<std::uint32_t>(plan.batches.size());
    frame.stats.batchesCulled += plan.batchesCulled;
    for (int p = 0; p < 3; ++p) frame.stats.batchesAt[p] += plan.batchesAt[p];
  }
}

/// Gives every page one run, or more where one dispatch cannot hold its batches.
void GlScene::layRuns(PreparedDraw& frame) {
  runs_.clear();
  records_.clear();
  candidateWords_ = 0;
  for (std::uint32_t page = 0; page < frame.pages.size(); ++page) {
    PreparedDraw::PerPage& here = frame.pages[page];
    const auto open = [&] {
      const auto firstRecord = runs_.empty() ? 0u : runs_.back().firstRecord + runs_.back().capacity;
      runs_.push_back({page, firstRecord, 0, 0, static_cast<std::uint32_t>(frame.parts.size()), 0});
      records_.resize(firstRecord);
      frame.places.resize(std::size_t{firstRecord} * constants_.size());
    };
    if (!here.parts.empty() || !here.records.empty()) open();
    for (std::size_t i = 0; i < here.records.size(); ++i) {
      if (runs_.back().capacity == kMostBoxes) open();
      const std::uint32_t words = here.records[i].firstCandidate;
      here.records[i].firstCandidate = static_cast<std::uint32_t>(candidateWords_);
      candidateWords_ += words;
      records_.push_back(here.records[i]);
      const auto from = here.places.begin() + static_cast<std::ptrdiff_t>(i * constants_.size());
      frame.places.insert(frame.places.end(), from, from + static_cast<std::ptrdiff_t>(constants_.size()));
      ++runs_.back().recordCount;
      ++runs_.back().capacity;
    }
    for (shader::DrawPart& part : here.parts) {
      for (std::size_t v = 0, firstGrid = 0; v < constants_.size(); firstGrid += frame.grids[v++].size())
        if (part.first[v].w >= 0) part.first[v].w += static_cast<int>(firstGrid);
      if (runs_.back().capacity + part.boxCount > kMostBoxes) open();
      const std::uint32_t words = part.firstCandidate;
      part.firstCandidate = static_cast<std::uint32_t>(candidateWords_);
      candidateWords_ += words;
      part.run = static_cast<std::uint32_t>(runs_.size() - 1);
      part.firstRecord = runs_.back().firstRecord;
      frame.parts.push_back(part);
      ++runs_.back().partCount;
      runs_.back().capacity += part.boxCount;
    }
  }
}

void GlScene::upload(const PreparedDraw& frame) {
  const std::size_t views = std::max<std::size_t>(constants_.size(), 1);
  const std::size_t capacity = runs_.empty() ? 0 : runs_.back().firstRecord + runs_.back().capacity;
  recordBuffer_.reserve(capacity * sizeof(shader::BatchRecord));
  placeBuffer_.reserve(capacity * views * sizeof(shader::BatchPlace));
  if (!records_.empty()) {
    recordBuffer_.write(0, records_.data(), records_.size() * sizeof(shader::BatchRecord));
    placeBuffer_.write(0, frame.places.data(), frame.places.size() * sizeof(shader::BatchPlace));
  }
  std::vector<shader::GridRecord> grids;
  for (const auto& ofView : frame.grids)
    for (const GridTransform& grid : ofView) grids.push_back(gridRecord(grid));
  std::vector<shader::ViewRecord> viewRecords;
  for (const ViewConstants& c : constants_) viewRecords.push_back(viewRecord(c, frame.options.clip));
  std::vector<shader::DispatchRecord> dispatches;
  for (const PageRun& run : runs_) dispatches.push_back({run.recordCount, 1, 1});
  if (!grids.empty()) gridBuffer_.assign(grids.data(), grids.size() * sizeof(shader::GridRecord));
  if (!viewRecords.empty()) viewBuffer_.assign(viewRecords.data(), viewRecords.size() * sizeof(shader::ViewRecord));
  if (!dispatches.empty()) runBuffer_.assign(dispatches.data(), dispatches.size() * sizeof(shader::DispatchRecord));
  if (!frame.parts.empty()) partBuffer_.assign(frame.parts.data(), frame.parts.size() * sizeof(shader::DrawPart));
}

void GlScene::dispatchPlan() {
  counters_.fill(0);
  const bool none = std::all_of(runs_.begin(), runs_.end(), [](const PageRun& run) { return run.partCount == 0; });
  if (none) return;
  plans_.get(ShaderVariant{variant_.views, false, false}).use();
  recordBuffer_.bindStorage(STRATA_BINDING_RECORDS);
  placeBuffer_.bindStorage(STRATA_BINDING_PLACES);
  partBuffer_.bindStorage(STRATA_BINDING_PARTS);
  viewBuffer_.bindStorage(STRATA_BINDING_VIEWS);
  runBuffer_.bindStorage(STRATA_BINDING_RUNS);
  bindCounters();
  gl_.Uniform3i(STRATA_UNIFORM_CLIPS, clips_.x, clips_.y, clips_.z);
  gl_.Uniform1i(STRATA_UNIFORM_FORCED, forcedPlanes_);
  for (const PageRun& run : runs_) {
    if (run.partCount == 0) continue;
    nodes_.bindPage(run.page);
    gl_.Uniform1ui(STRATA_UNIFORM_FIRST_PART, run.firstPart);
    gl_.DispatchCompute(run.partCount, 1, 1);
  }
  gl_.MemoryBarrier(gl::kShaderStorageBarrier | gl::kCommandBarrier | gl::kBufferUpdateBarrier);
}

shader::Counters GlScene::readCounters() const {
  shader::Counters counters{};
  counters_.read(0, &counters, sizeof counters);
  return counters;
}

void GlScene::bind(const PageRun& run) const {
  nodes_.bindPage(run.page);
  recordBuffer_.bindStorage(STRATA_BINDING_RECORDS);
  placeBuffer_.bindStorage(STRATA_BINDING_PLACES);
  gridBuffer_.bindStorage(STRATA_BINDING_GRIDS);
}

/// A work-group for each record of the run; plan.comp has counted them.
void GlScene::dispatch(const PageRun& run) const {
  bind(run);
  gl_.Uniform1ui(STRATA_UNIFORM_FIRST_RECORD, run.firstRecord);
  gl_.BindBuffer(gl::kDispatchIndirectBuffer, runBuffer_.name());
  gl_.DispatchComputeIndirect(static_cast<std::ptrdiff_t>(&run - runs_.data()) *
                              static_cast<std::ptrdiff_t>(sizeof(shader::DispatchRecord)));
}

void GlScene::setViewUniforms() const {
  std::vector<glm::vec4> viewports;
  std::vector<glm::vec4> lenses;
  for (const ViewConstants& c : constants_) {
    const strata::Viewport port = viewport(c);
    viewports.emplace_back(port.halfWidth, port.halfHeight, port.width, port.height);
    lenses.emplace_back(port.nearDepth, port.perspective ? 1.0f : 0.0f, port.left, port.top);
  }
  const int count = static_cast<int>(constants_.size());
  gl_.Uniform4fv(STRATA_UNIFORM_VIEWPORT, count, &viewports[0].x);
  gl_.Uniform4fv(STRATA_UNIFORM_LENS, count, &lenses[0].x);
  gl_.Uniform3i(STRATA_UNIFORM_CLIPS, clips_.x, clips_.y, clips_.z);
  if (!variant_.classes) return;
  std::uint32_t words[8] = {};
  for (std::size_t c = 0; c < classes_.size(); ++c) words[c / 32] |= (classes_[c] ? 1u : 0u) << (c % 32);
  gl_.Uniform1uiv(STRATA_UNIFORM_CLASSES, 8, words);
}

}  // namespace strata
