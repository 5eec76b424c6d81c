#include "viewer/window/layer_renderer.h"

#include <chrono>
#include <utility>

#include "viewer/session/program_rasterizer.h"

namespace strata {
namespace {

constexpr double kSmoothing = 0.1;  // share of the newest frame in the frame time shown

}  // namespace

LayerRenderer::LayerRenderer(std::vector<std::shared_ptr<const Store>> stores, const ViewerOptions& options,
                             GlContext::GetProc getProc)
    : getProc_(getProc), layers_(std::move(stores), options.streamer), texture_(getProc), backend_(options.backend) {
  std::uint64_t points = 0;
  for (const auto& store : layers_.stores()) points += store->info().points;
  use(createRasterizerFor(options.backend,
                          progressiveOptions(options.progressive, options.streamer.selection.pointBudget, points),
                          adoptCurrentContext(getProc)));
}

void LayerRenderer::use(std::unique_ptr<Rasterizer> rasterizer) {
  rasterizer_ = std::move(rasterizer);
  progressive_ = dynamic_cast<ProgressiveRasterizer*>(rasterizer_.get());
  rasterizerName_ = std::string(rasterizer_->name()) + ", " + rasterizer_->device();
}

void LayerRenderer::switchTo(Backend backend) {
  if (backend == backend_) return;
  use(createRasterizer(backend, {}, adoptCurrentContext(getProc_)));
  backend_ = backend;
}

void LayerRenderer::draw(const View& view, const View& chosenFor, const DrawOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const View ahead = motion_.ahead(view, start);
  layers_.setView(chosenFor, chosenFor == view ? ahead : chosenFor);
  const RenderList& list = layers_.beginFrame();
  list_ = &list;
  report_.draw = rasterizer_->draw(list, view, options, picture_);
  texture_.upload(picture_);
  const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  report_.frameMs = report_.frameMs == 0.0 ? ms : report_.frameMs + kSmoothing * (ms - report_.frameMs);
  report_.missingNodes = list.missingNodes;
  report_.complete = layers_.complete();
  report_.streamer = layers_.stats();
  report_.nodesDrawn = list.items.size();
  report_.history.add(start, {ms, report_.draw.pointsDrawn, list.items.size(), list.missingNodes}, report_.streamer);
  ++report_.framesDrawn;
}

}  // namespace strata
