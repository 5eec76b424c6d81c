#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/view.h"
#include "viewer/session/class_census.h"
#include "viewer/session/project.h"
#include "viewer/tools/clip_boxes.h"
#include "viewer/tools/measure_tool.h"
#include "viewer/tools/pick.h"

namespace strata {

/// What the tools' panel shows and changes.
struct ToolsState {
  MeasureTool measure;
  std::optional<PickedPoint> picked;  ///< of the last click
  bool lookingUp = false;
  ClipTool clip;
  ClassCensus census;                                   ///< of the nodes that were drawn
  std::bitset<256> classes = std::bitset<256>().set();  ///< those to be drawn
  std::vector<Bookmark> bookmarks;
  std::vector<std::string> layers;          ///< names of the stores
  std::vector<bool> shown;                  ///< by store
  std::string exportBase = "measurements";  ///< file name without its ending
};

/// What the user asked for in the panel, for the app to do.
struct ToolsRequest {
  bool layersChanged = false;
  bool pictureChanged = false;  ///< something else that it shows
  bool exportCsv = false, exportGeoJson = false;
  bool saveProject = false;
  bool addBookmark = false;
  std::optional<View> goTo;
  std::optional<std::size_t> showProfile;  ///< index among the measurements
};

/// Draws the tools' panel at the right edge of the window that `view` fills; between Window::beginFrame() and
/// finishFrame(). `bounds` are those of the scan.
ToolsRequest drawToolsPanel(ToolsState& state, const View& view, const Box& bounds);

/// Lines, points and figures of the measurements over the picture.
void drawMeasurements(const MeasureTool& tool, const View& view, const std::optional<PickedPoint>& picked);

}  // namespace strata
