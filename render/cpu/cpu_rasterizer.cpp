#include "render/cpu/cpu_rasterizer.h"

#include <algorithm>

#include "render/cpu/cpu_draw.h"
#include "render/cpu/cpu_kernel.h"
#include "render/picture/resolve.h"
#include "render/stopwatch.h"

namespace strata {
namespace {

constexpr std::size_t kViewsAtOnce = 2;

class CpuRasterizer final : public Rasterizer {
 public:
  explicit CpuRasterizer(const RasterizerOptions& options) : pool_(options.threads) {}

  DrawStats draw(const RenderList& list, const View& view, const DrawOptions& options, Picture& picture) override {
    return drawViews(list, {&view, 1}, options, {&picture, 1});
  }

  DrawStats drawViews(const RenderList& list, std::span<const View> views, const DrawOptions& options,
                      std::span<Picture> pictures) override {
    DrawStats sum;
    for (std::size_t first = 0; first < std::min(views.size(), pictures.size()); first += kViewsAtOnce) {
      const std::size_t count = std::min({kViewsAtOnce, views.size() - first, pictures.size() - first});
      addStats(drawSome(list, views.subspan(first, count), options, pictures.subspan(first, count)), sum);
    }
    return sum;
  }

  std::string_view name() const override { return "cpu"; }

  std::string device() const override {
    const int threads = pool_.threads();
    return std::to_string(threads) + (threads == 1 ? " thread, " : " threads, ") + kernelTarget();
  }

 private:
  DrawStats drawSome(const RenderList& list, std::span<const View> views, const DrawOptions& options,
                     std::span<Picture> pictures) {
    Stopwatch watch;
    const std::span<CpuTarget> targets(targets_, views.size());
    DrawStats sum;
    for (std::size_t v = 0; v < views.size(); ++v) {
      planBatches(list, views[v], options, targets[v].plan);
      clearTarget(targets[v], pool_);
      addStats(planStats(targets[v].plan), sum);
    }
    drawBatches(targets, options, pool_);
    sum.drawMs = watch.lapMs();
    for (std::size_t v = 0; v < views.size(); ++v)
      resolvePicture({list, views[v], options}, {pool_}, targets[v].buffer, pictures[v]);
    sum.resolveMs = watch.lapMs();
    return sum;
  }

  ThreadPool pool_;
  CpuTarget targets_[kViewsAtOnce];
};

}  // namespace

std::unique_ptr<Rasterizer> createCpuRasterizer(const RasterizerOptions& options) {
  return std::make_unique<CpuRasterizer>(options);
}

}  // namespace strata
