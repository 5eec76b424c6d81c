#include "viewer/window/viewer_session.h"
#include "viewer/session/draw_defaults.h"

#include <algorithm>

namespace strata {
namespace {

constexpr double kNearShare = 1e-5;  // of the scan's diagonal: how near the eye may come to something small

}  // namespace

ViewerSession beginSession(const ViewerOptions& options, const OpenedStores& opened, View view, const Box& bounds) {
  view.nearPlane = std::min(view.nearPlane, kNearShare * bounds.diagonal());
  ViewerSession session{.camera = CameraControl(view)};
  ViewerSettings& settings = session.settings;
  settings.selection = options.streamer.selection;
  settings.backend = options.backend;
  settings.draw = drawOptionsFor(opened.stores.front()->info(), bounds, options.colour);
  applyDrawFlags(options.draw, settings.draw);
  settings.draw.pointSize = options.pointSize;
  settings.draw.edl = options.edl;
  ToolsState& tools = session.tools;
  for (const std::size_t i : opened.asked) tools.layers.push_back(layerNames({options.stores[i]}));
  tools.shown.assign(opened.asked.size(), true);
  tools.classes = settings.draw.classes;
  for (const Box& box : settings.draw.clip.boxes) tools.clip.add(box);
  session.clipPlanes = settings.draw.clip.planes;
  session.shownPaths.assign(options.stores.size(), true);
  return session;
}

void restoreSession(ViewerSession& session, const Project& project, const OpenedStores& opened) {
  session.settings.draw = project.draw;
  session.settings.selection.pointBudget = project.pointBudget;
  session.settings.selection.pointsPerPixel = project.pointsPerPixel;
  session.shownPaths = project.shown;
  ToolsState& tools = session.tools;
  for (std::size_t i = 0; i < opened.asked.size(); ++i) tools.shown[i] = project.shown[opened.asked[i]];
  tools.bookmarks = project.bookmarks;
  tools.classes = project.draw.classes;
  tools.clip.boxes() = project.clipBoxes;
  tools.measure.kept() = project.measurements;
  session.camera.setView(project.view);
}

Project projectOf(const ViewerSession& session, const OpenedStores& opened, const std::vector<std::string>& paths,
                  const std::optional<CameraPath>& path) {
  std::vector<bool> shown = session.shownPaths;
  for (std::size_t i = 0; i < opened.asked.size(); ++i) shown[opened.asked[i]] = session.tools.shown[i];
  return {.stores = paths,
          .shown = shown,
          .view = session.camera.view(),
          .draw = session.settings.draw,
          .clipBoxes = session.tools.clip.boxes(),
          .pointBudget = session.settings.selection.pointBudget,
          .pointsPerPixel = session.settings.selection.pointsPerPixel,
          .bookmarks = session.tools.bookmarks,
          .measurements = session.tools.measure.kept(),
          .path = path};
}

void applyTools(ViewerSession& session) {
  session.settings.draw.clip = clipOf(session.tools.clip.boxes(), session.clipPlanes);
  session.settings.draw.classes = session.tools.classes;
}

ColourLimits colourLimits(const std::vector<std::shared_ptr<const Store>>& stores, const ViewerOptions& options,
                          const Box& bounds, const DrawOptions& draw) {
  ColourLimits limits;
  limits.elevation = draw.elevationRange;
  limits.automatic = drawOptionsFor(stores.front()->info(), bounds, options.colour);
  for (const auto& store : stores) {
    const StoreInfo& info = store->info();
    limits.levels = std::max(limits.levels, info.levels);
    const int intensity = info.layout.find(attribute::kIntensity);
    if (intensity < 0) continue;
    const AttributeRange& range = info.ranges[static_cast<std::size_t>(intensity)];
    limits.intensity = {static_cast<float>(range.min), static_cast<float>(std::max(range.max, range.min + 1.0))};
  }
  return limits;
}

}  // namespace strata
