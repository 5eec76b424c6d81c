#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/view.h"
#include "viewer/measure_tool.h"
#include "viewer/pick.h"
#include "viewer/project.h"

namespace strata {

/// What the tools' panel shows and changes.
struct ToolsState {
  MeasureTool measure;
  std::optional<PickedPoint> picked;  ///< of the last click
  bool lookingUp = false;
  std::vector<Bookmark> bookmarks;
  std::vector<std::string> layers;          ///< names of the stores
  std::vector<bool> shown;                  ///< by store
  std::string exportBase = "measurements";  ///< file name without its ending
};

/// What the user asked for in the panel, for the app to do.
struct ToolsRequest {
  bool layersChanged = false;
  bool exportCsv = false, exportGeoJson = false;
  bool saveProject = false;
  bool addBookmark = false;
  std::optional<View> goTo;
};

/// Draws the tools' panel at the right edge of a window of `width` pixels; between Window::beginFrame() and
/// finishFrame().
ToolsRequest drawToolsPanel(ToolsState& state, int width);

/// Lines, points and figures of the measurements over the picture.
void drawMeasurements(const MeasureTool& tool, const View& view, const std::optional<PickedPoint>& picked);

}  // namespace strata
