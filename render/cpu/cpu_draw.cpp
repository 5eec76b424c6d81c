#include "render/cpu/cpu_draw.h"

#include <algorithm>
#include <array>
#include <atomic>

#include "render/cpu/cpu_kernel.h"
#include "render/picture/point_colour.h"

namespace strata {
namespace {

constexpr std::size_t kPixelsAtOnce = std::size_t{1} << 16;
constexpr std::size_t kMostViews = 2;
/// Points per pixel, for each thread except the first, from which own pixels pay off; measured, see
/// docs/rasterizers.md.
constexpr std::size_t kPointsAPixelToOwn = 2;

/// A batch of the list, as each view has planned it; null where a view does not draw it in this task.
struct Task {
  const PlannedBatch* batches[kMostViews] = {};
  int firstView = 0, views = 1;

  const PlannedBatch& any() const { return *batches[firstView]; }
};

/// The batches of one or two plans in list order. A batch that both plans draw with the same precision is one task.
/// Both plans ascend by id, so this is a merge.
std::vector<Task> makeTasks(std::span<const CpuTarget> targets) {
  std::vector<Task> tasks;
  std::size_t next[kMostViews] = {};
  const auto head = [&](std::size_t v) -> const PlannedBatch* {
    if (v >= targets.size() || next[v] == targets[v].plan.batches.size()) return nullptr;
    return &targets[v].plan.batches[next[v]];
  };
  for (;;) {
    const PlannedBatch* a = head(0);
    const PlannedBatch* b = head(1);
    if (a == nullptr && b == nullptr) return tasks;
    const bool joint = a != nullptr && b != nullptr && a->firstId == b->firstId && a->precision == b->precision;
    const bool first = a != nullptr && (b == nullptr || a->firstId <= b->firstId);
    if (joint)
      tasks.push_back({{a, b}, 0, 2});
    else
      tasks.push_back({{first ? a : nullptr, first ? nullptr : b}, first ? 0 : 1, 1});
    next[0] += joint || first;
    next[1] += joint || !first;
  }
}

KernelView kernelView(const CpuTarget& target, const PlannedBatch& batch) {
  const GridTransform& grid = target.plan.grids[batch.mapping.grid];
  KernelView view;
  view.x = grid.x;
  view.y = grid.y;
  view.depth = grid.depth;
  view.offset = batch.mapping.offset;
  view.shift = batch.mapping.shift;
  view.inside = batch.inside;
  view.clip = batch.clipped ? &grid : nullptr;
  view.port = viewport(target.plan.constants);
  return view;
}

/// DrawOptions::classes in the form that the kernel takes: one word per point.
class ClassFilter {
 public:
  explicit ClassFilter(const DrawOptions& options) : all_(options.classes.all()) {
    for (std::size_t c = 0; c < words_.size(); ++c) words_[c] = options.classes[c] ? ~std::uint32_t{0} : 0u;
  }
  /// Fills `words` and returns it; null where every point is drawn.
  const std::uint32_t* keep(const NodeData& node, std::size_t first, std::size_t count, std::uint32_t* words) const {
    if (all_ || node.classification.empty()) return nullptr;
    for (std::size_t i = 0; i < count; ++i) words[i] = words_[node.classification[first + i]];
    return words;
  }

 private:
  bool all_;
  std::array<std::uint32_t, 256> words_;
};

/// What the passes over the points share.
struct Draw {
  std::span<CpuTarget> targets;
  const DrawOptions& options;
  const ThreadPool& pool;
  std::vector<Task> tasks;
  ClassFilter filter;
};

/// Projects the batch of a task block by block, with depth tests against pixelsOf(view), and calls use(view, block)
/// with the points that each view keeps.
template <typename Pixels, typename Use>
void forEachBlock(const Draw& draw, const Task& task, Wanted wanted, const Pixels& pixelsOf, const Use& use) {
  KernelView views[kMostViews];
  for (int v = 0; v < task.views; ++v) {
    const auto target = static_cast<std::size_t>(task.firstView + v);
    views[v] = kernelView(draw.targets[target], *task.batches[target]);
    views[v].pixels = pixelsOf(target);
  }
  const PlannedBatch& batch = task.any();
  ProjectedBlock blocks[kMostViews];
  std::uint32_t keep[ProjectedBlock::kPoints];
  for (std::uint32_t done = 0; done < batch.pointCount; done += ProjectedBlock::kPoints) {
    KernelPoints points;
    points.precision = batch.precision;
    points.count = std::min<std::size_t>(batch.pointCount - done, ProjectedBlock::kPoints);
    points.firstId = batch.firstId + done;
    for (int p = 0; p < static_cast<int>(batch.precision); ++p)
      points.planes[p] = batch.node->position[p].data() + batch.firstPoint + done;
    points.keep = draw.filter.keep(*batch.node, batch.firstPoint + done, points.count, keep);
    projectPoints(points, views, task.views, wanted, blocks);
    for (int v = 0; v < task.views; ++v) use(static_cast<std::size_t>(task.firstView + v), blocks[v]);
  }
}

/// Lowers a pixel that several threads share. A minimum does not depend on the order of the threads, so a picture
/// repeats bit for bit.
void lowerShared(PackedPixel& target, PackedPixel value) {
  std::atomic_ref<PackedPixel> pixel(target);
  PackedPixel seen = pixel.load(std::memory_order_relaxed);
  while (value < seen && !pixel.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
}

void lower(PackedPixel& target, PackedPixel value) { target = std::min(target, value); }

template <typename Word>
void add(Word& sum, Word value, bool shared) {
  if (shared)
    std::atomic_ref<Word>(sum).fetch_add(value, std::memory_order_relaxed);
  else
    sum += value;
}

void fillPixels(std::vector<PackedPixel>& pixels, std::size_t count, const ThreadPool& pool) {
  resizePixels(pixels, count);
  pool.parallelFor(count, kPixelsAtOnce, [&](std::size_t begin, std::size_t end) {
    std::fill(pixels.begin() + static_cast<std::ptrdiff_t>(begin), pixels.begin() + static_cast<std::ptrdiff_t>(end),
              kEmptyPixel);
  });
}

/// True when pixels of their own, which must be merged afterwards, cost the threads less than a compare-and-swap for
/// each point.
bool ownPixelsPay(const CpuTarget& target, int threads) {
  return threads > 1 && target.plan.pointCount >
                            kPointsAPixelToOwn * target.buffer.pixels.size() * static_cast<std::size_t>(threads - 1);
}

void makeOwnPixels(CpuTarget& target, int threads) {
  target.privatePixels.resize(static_cast<std::size_t>(threads - 1));
  for (auto& own : target.privatePixels) resizePixels(own, target.buffer.pixels.size());
}

void mergeOwnPixels(CpuTarget& target, const ThreadPool& pool) {
  std::vector<PackedPixel>& pixels = target.buffer.pixels;
  pool.parallelFor(pixels.size(), kPixelsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (auto& own : target.privatePixels) mergePixels(pixels.data() + begin, own.data() + begin, end - begin);
  });
}

void drawFront(const Draw& draw) {
  const std::span<CpuTarget> targets = draw.targets;
  const ThreadPool& pool = draw.pool;
  const int threads = pool.threads();
  bool own = true;
  for (const CpuTarget& target : targets) own = own && ownPixelsPay(target, threads);
  for (CpuTarget& target : targets)
    if (own) makeOwnPixels(target, threads);
  const bool shared = threads > 1 && !own;
  pool.parallelForSlots(draw.tasks.size(), 1, [&](std::size_t begin, std::size_t end, std::size_t slot) {
    const auto pixelsOf = [&](std::size_t view) {
      CpuTarget& target = targets[view];
      return own && slot > 0 ? target.privatePixels[slot - 1].data() : target.buffer.pixels.data();
    };
    for (std::size_t t = begin; t < end; ++t)
      forEachBlock(draw, draw.tasks[t], Wanted::front, pixelsOf, [&](std::size_t view, const ProjectedBlock& block) {
        PackedPixel* pixels = pixelsOf(view);
        if (shared)
          for (std::size_t i = 0; i < block.count; ++i)
            lowerShared(pixels[block.pixel[i]], packPixel(block.depthBits[i], block.id[i]));
        else
          for (std::size_t i = 0; i < block.count; ++i)
            lower(pixels[block.pixel[i]], packPixel(block.depthBits[i], block.id[i]));
      });
  });
  for (CpuTarget& target : targets)
    if (own) mergeOwnPixels(target, pool);
}

/// Sums the colours of the points near each pixel's front, which is final by now.
void blendNear(const Draw& draw) {
  const std::span<CpuTarget> targets = draw.targets;
  const std::vector<Task>& tasks = draw.tasks;
  const DrawOptions& options = draw.options;
  for (CpuTarget& target : targets) target.buffer.sums.assign(target.buffer.pixels.size(), {});
  const bool shared = draw.pool.threads() > 1;
  const auto finished = [&](std::size_t view) { return targets[view].buffer.pixels.data(); };
  draw.pool.parallelFor(tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const PlannedBatch& batch = tasks[t].any();
      const std::uint32_t idOfNode = batch.firstId - batch.firstPoint;
      const bool hasRgb = options.colour == ColourMode::rgb && !batch.node->colour.empty();
      const std::uint32_t* const rgb = hasRgb ? batch.node->colour.data() : nullptr;
      forEachBlock(draw, tasks[t], Wanted::near, finished, [&](std::size_t view, const ProjectedBlock& block) {
        for (std::size_t i = 0; i < block.count; ++i) {
          const std::uint32_t point = block.id[i] - idOfNode;
          const std::uint64_t colour =
              rgb != nullptr ? rgb[point] : pointColour(*batch.node, point, options, batch.precision);
          ColourSum& sum = targets[view].buffer.sums[block.pixel[i]];
          add(sum.redGreen, (colour & 255u) | (colour >> 8 & 255u) << 32, shared);
          add(sum.blueCount, (colour >> 16 & 255u) | std::uint64_t{1} << 32, shared);
        }
      });
    }
  });
}

void countAll(const Draw& draw) {
  const std::span<CpuTarget> targets = draw.targets;
  for (CpuTarget& target : targets) target.buffer.counts.assign(target.buffer.pixels.size(), 0);
  const bool shared = draw.pool.threads() > 1;
  const auto finished = [&](std::size_t view) { return targets[view].buffer.pixels.data(); };
  draw.pool.parallelFor(draw.tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      forEachBlock(draw, draw.tasks[t], Wanted::all, finished, [&](std::size_t view, const ProjectedBlock& block) {
        for (std::size_t i = 0; i < block.count; ++i) add(targets[view].buffer.counts[block.pixel[i]], 1u, shared);
      });
  });
}

}  // namespace

void clearTarget(CpuTarget& target, const ThreadPool& pool) {
  VisibilityBuffer& buffer = target.buffer;
  buffer.width = std::max(target.plan.constants.view.width, 0);
  buffer.height = std::max(target.plan.constants.view.height, 0);
  const std::size_t count = static_cast<std::size_t>(buffer.width) * static_cast<std::size_t>(buffer.height);
  fillPixels(buffer.pixels, count, pool);
}

void drawBatches(std::span<CpuTarget> targets, const DrawOptions& options, const ThreadPool& pool) {
  const Draw draw{targets, options, pool, makeTasks(targets), ClassFilter(options)};
  drawFront(draw);
  if (options.colour == ColourMode::overdraw)
    countAll(draw);
  else if (options.shading == Shading::highQuality)
    blendNear(draw);
}

}  // namespace strata
