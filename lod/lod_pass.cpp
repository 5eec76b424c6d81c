#include "lod/lod_pass.h"

#include <algorithm>

#include <glm/glm.hpp>

namespace strata {
namespace {

/// How long to wait for the next list while nodes are held back by Fade.
constexpr std::chrono::milliseconds kFadeStep{16};

}  // namespace

LodPass::LodPass(const Store& store, const HierarchyIndex& index, Precision leastPrecision, NodeCache& cache,
                 DepthBuffers& depth)
    : store_(store),
      index_(index),
      cache_(cache),
      depth_(depth),
      builder_(store, index.parent, leastPrecision, cache),
      fade_(store.hierarchy(), index) {}

const CoarseDepth* LodPass::fillCoarseDepth(const LodTask& task) {
  const OcclusionOptions& options = task.selection.occlusion;
  if (!options.enabled) return nullptr;
  CoarseDepth& depth = depth_.back();
  depth.clear(task.view, options);
  // The occluders are those of the nodes drawn last that are still resident, as the new view sees them.
  cache_.pin(builder_.drawn(), occluding_, occludingPins_);
  bySize_.clear();
  for (const NodeCache::Data& node : occluding_) {
    if (node == nullptr || node->occluding.occluders.empty()) continue;
    const glm::dvec3 fromEye = node->occluding.origin - task.view.eye;
    const double side = node->occluding.cellSide;
    bySize_.emplace_back(side * side / glm::dot(fromEye, fromEye), &node->occluding);
  }
  std::sort(bySize_.begin(), bySize_.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [size, set] : bySize_) depth.add(*set);
  depth.finish();
  occluding_.clear();  // before the pins: an evicted node's memory is used again if nobody else holds it
  cache_.unpin(occludingPins_, released_);
  occludingPins_.clear();
  released_.clear();
  return &depth_.publish();
}

LodPass::Result LodPass::run(const LodTask& task, const FailedNodes& failed, Fade::Time now, LodOutput& out,
                             TraceLane* lane) {
  TraceScope step(lane, "coarse depth");
  const CoarseDepth* const depth = fillCoarseDepth(task);
  step.next("select");
  const SelectionTree tree(store_.hierarchy(), index_.reach);
  selectNodes(tree, task.view, depth, task.selection, selection_);
  failed.copyIfNewer(failures_, failuresVersion_);
  step.next("build the list");
  fade_.begin(task.selection.fadeSeconds, now);
  Result result{builder_.build(selection_, task.selection, failures_, fade_, out), selection_.occluded,
                depth != nullptr ? depth->drawn() : 0, fade_.held()};
  fade_.end(task.view, selection_.hidden);
  if (result.fading > 0) result.retryAt = std::min(result.retryAt, now + kFadeStep);
  out.pinned.list.view = task.view;
  if (task.ahead) {
    step.next("look ahead");
    selectNodes(tree, *task.ahead, task.selection, selectionAhead_);
    builder_.lookAhead(selectionAhead_, failures_, out.requests);
  }
  return result;
}

}  // namespace strata
