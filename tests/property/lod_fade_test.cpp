// How fast nodes come in along flights, in seconds of the path. Everything is in memory, for a node that was missing
// may come at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <vector>

#include "lod/lod_pass.h"
#include "lod/streamed_node.h"
#include "tests/support/lod_store.h"
#include "tests/support/lod_town.h"

namespace strata {
namespace {

constexpr double kFps = 30.0;
constexpr int kTenth = 3;  // frames

/// Leaves hold the rest of a scan, so most have few points, and a view soon wants all of them.
test::Town townOfThinLeaves() {
  constexpr std::uint32_t kThinner = 8;  // along an axis
  test::Town town(20'001);
  for (NodeRecord& record : town.hierarchy.nodes) {
    if (record.childMask != 0) continue;
    record.pointCount /= kThinner * kThinner;
    record.spacing *= kThinner;
  }
  return town;
}

/// A town in which every node that is asked for is resident, with the right number of points and nothing else.
class ResidentTown {
 public:
  ResidentTown() : index_(indexHierarchy(town.hierarchy)), store_(town.info, town.hierarchy, noBytes()) {}

  test::Town town = townOfThinLeaves();

  struct Worst {
    double growth = 0.0;  ///< the largest share of its points that a node gained within a tenth of a second
    int jumps = 0;        ///< nodes that grew from nothing to all in that time
    std::size_t nodes = 0;
  };

  /// `at` gives the view after so many seconds of the path. Only nodes that were in view all the time are counted.
  Worst fly(const std::function<View(double)>& at, double seconds, double fadeSeconds) {
    NodeCache cache(std::uint64_t{16} << 30, index_.parent);
    DepthBuffers depth;
    LodPass lod(store_, index_, Precision::low10, cache, depth);
    const FailedNodes failed(std::chrono::milliseconds{250});
    LodTask task;
    task.selection.fadeSeconds = fadeSeconds;
    task.selection.pointBudget = SelectionOptions::kMaxPointBudget;
    Worst worst;
    std::deque<std::vector<float>> shares;
    std::deque<View> views;
    for (int frame = 0; frame < seconds * kFps; ++frame) {
      task.view = at(frame / kFps);
      load(task, cache);
      LodOutput out;
      const auto now = Fade::Time{} + std::chrono::microseconds(static_cast<std::int64_t>(1e6 * frame / kFps));
      lod.run(task, failed, now, out, nullptr);
      RenderList& list = out.pinned.list;
      EXPECT_EQ(list.missingNodes, 0u);
      std::vector<float> share(town.hierarchy.nodes.size(), 0.0f);
      for (const RenderItem& item : list.items)
        share[item.index] = static_cast<float>(item.pointCount) / static_cast<float>(item.node->pointCount());
      worst.nodes = std::max(worst.nodes, list.items.size());
      shares.push_back(std::move(share));
      views.push_back(task.view);
      if (shares.size() > kTenth) {
        compare(shares.front(), shares.back(), views, worst);
        shares.pop_front();
        views.pop_front();
      }
      std::vector<NodeCache::Released> released;
      list.items.clear();
      cache.unpin(out.pinned.pins, released);
    }
    return worst;
  }

 private:
  static std::unique_ptr<ByteSource> noBytes() { return std::make_unique<test::MemoryBytes>(std::vector<std::byte>{}); }
  void load(const LodTask& task, NodeCache& cache) {
    selectNodes({town.hierarchy, index_.reach}, task.view, task.selection, selection_);
    std::vector<NodeCache::Released> released;
    for (const SelectedNode& selected : selection_.nodes) {
      if (cache.contains(selected.node)) continue;
      auto node = std::make_shared<StreamedNode>();
      node->key = NodeKey{town.hierarchy.nodes[selected.node].key};
      node->position[0].resize(town.hierarchy.nodes[selected.node].pointCount);
      cache.insert(selected.node, std::move(node), released);
    }
  }
  void compare(const std::vector<float>& before, const std::vector<float>& now, const std::deque<View>& views,
               Worst& worst) const {
    for (std::uint32_t node = 0; node < now.size(); ++node) {
      if (now[node] <= before[node]) continue;
      const Contour contour = contourOf(town.hierarchy.nodes[node]);
      const bool inView = std::all_of(views.begin(), views.end(), [&](const View& view) {
        return contourInView(contour, static_cast<double>(index_.reach[node]), ViewVolume(view));
      });
      if (!inView) continue;
      worst.growth = std::max(worst.growth, static_cast<double>(now[node] - before[node]));
      worst.jumps += before[node] == 0.0f && now[node] == 1.0f ? 1 : 0;
    }
  }

  HierarchyIndex index_;
  Store store_;
  Selection selection_;
};

TEST(Fade, NoNodeInViewComesFromNothingToAllWithinATenthOfASecondOfAFlight) {
  ResidentTown scene;
  const View street = scene.town.along(0.0, 2.0);
  const glm::dvec3 middle = scene.town.info.bounds.centre();
  const auto orbit = [&](double t) {
    View view = street;
    view.eye = glm::dvec3(middle.x + 300.0 * std::cos(0.5 * t), middle.y + 300.0 * std::sin(0.5 * t), 90.0);
    view.target = glm::dvec3(middle.x, middle.y, 0.0);
    return view;
  };
  const auto flythrough = [&](double t) { return scene.town.along(25.0 * t, 4.0); };
  const auto dive = [&](double t) {
    View view = street;
    view.eye.z += 200.0 * std::exp(-2.5 * t);
    view.target = view.eye + glm::dvec3(0.0, 1.0, -1.0);
    return view;
  };
  int jumpsWithout = 0;
  const std::pair<const char*, std::function<View(double)>> paths[] = {
      {"orbit", orbit}, {"flythrough", flythrough}, {"dive", dive}};
  for (const auto& [name, path] : paths) {
    const ResidentTown::Worst worst = scene.fly(path, 3.0, SelectionOptions{}.fadeSeconds);
    EXPECT_EQ(worst.jumps, 0) << name;
    EXPECT_LT(worst.growth, 0.51) << name << ": a tenth of the second in which a node may come, of two";
    EXPECT_GT(worst.nodes, 50u) << name;
    const ResidentTown::Worst without = scene.fly(path, 3.0, 0.0);
    jumpsWithout += without.jumps;
    EXPECT_GE(without.growth + 1e-6, worst.growth) << name;
  }
  EXPECT_GT(jumpsWithout, 0) << "or these flights show nothing";
}

}  // namespace
}  // namespace strata
