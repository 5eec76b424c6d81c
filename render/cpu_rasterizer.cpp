#include "render/cpu_rasterizer.h"

#include <algorithm>
#include <atomic>

#include "render/batch_plan.h"
#include "render/cpu_kernel.h"
#include "render/resolve.h"
#include "render/stopwatch.h"
#include "render/thread_pool.h"

namespace strata {
namespace {

constexpr std::size_t kPixelsAtOnce = std::size_t{1} << 16;

/// The minimum does not depend on the order of the threads, so a frame repeats bit for bit.
void lower(PackedPixel& target, PackedPixel value) {
  std::atomic_ref<PackedPixel> pixel(target);
  PackedPixel seen = pixel.load(std::memory_order_relaxed);
  while (value < seen && !pixel.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
}

void drawBatch(const DrawPlan& plan, const PlannedBatch& batch, const Viewport& view,
               std::vector<PackedPixel>& pixels) {
  const GridTransform& grid = plan.grids[batch.place.grid];
  const BatchTransform transform{grid.x, grid.y, grid.depth, batch.place.offset, batch.place.shift};
  ProjectedBlock block;
  for (std::uint32_t done = 0; done < batch.pointCount; done += ProjectedBlock::kPoints) {
    const std::size_t count = std::min<std::size_t>(batch.pointCount - done, ProjectedBlock::kPoints);
    const std::uint32_t* planes[3] = {};
    for (int p = 0; p < static_cast<int>(batch.precision); ++p)
      planes[p] = batch.node->position[p].data() + batch.firstPoint + done;
    const std::size_t inside =
        projectPoints(transform, view, planes, batch.precision, count, batch.firstId + done, block);
    for (std::size_t i = 0; i < inside; ++i) lower(pixels[block.pixel[i]], packPixel(block.depthBits[i], block.id[i]));
  }
}

class CpuRasterizer final : public Rasterizer {
 public:
  explicit CpuRasterizer(const RasterizerOptions& options) : pool_(options.threads) {}

  DrawStats draw(const RenderList& list, const View& view, const DrawOptions& options, Frame& frame) override {
    Stopwatch watch;
    planBatches(list, view, options, plan_);
    clear(view);
    const Viewport port = viewport(plan_.constants);
    pool_.parallelFor(plan_.batches.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) drawBatch(plan_, plan_.batches[i], port, buffer_.pixels);
    });
    DrawStats stats = planStats(plan_);
    stats.drawMs = watch.lapMs();
    resolveFrame(list, view, options, buffer_, pool_, frame);
    stats.resolveMs = watch.lapMs();
    return stats;
  }

  std::string_view name() const override { return "cpu"; }

  std::string device() const override {
    const int threads = pool_.threads();
    return std::to_string(threads) + (threads == 1 ? " thread, " : " threads, ") + kernelTarget();
  }

 private:
  void clear(const View& view) {
    buffer_.width = std::max(view.width, 0);
    buffer_.height = std::max(view.height, 0);
    buffer_.pixels.resize(static_cast<std::size_t>(buffer_.width) * static_cast<std::size_t>(buffer_.height));
    pool_.parallelFor(buffer_.pixels.size(), kPixelsAtOnce, [&](std::size_t begin, std::size_t end) {
      std::fill(buffer_.pixels.begin() + static_cast<std::ptrdiff_t>(begin),
                buffer_.pixels.begin() + static_cast<std::ptrdiff_t>(end), kEmptyPixel);
    });
  }

  ThreadPool pool_;
  DrawPlan plan_;
  VisibilityBuffer buffer_;
};

}  // namespace

std::unique_ptr<Rasterizer> createCpuRasterizer(const RasterizerOptions& options) {
  return std::make_unique<CpuRasterizer>(options);
}

}  // namespace strata
