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

/// What the panel "Tools" shows and changes.
struct ToolsState {
  MeasureTool measure;
  std::optional<PickedPoint> picked;  ///< the point clicked last
  bool lookingUp = false;             ///< a point is being read from the disk
  ClipTool clip;
  ClassCensus census;                                   ///< of the nodes drawn so far
  std::bitset<256> classes = std::bitset<256>().set();  ///< the classes that are drawn
  std::vector<Bookmark> bookmarks;
  std::vector<std::string> layers;          ///< names of the stores
  std::vector<bool> shown;                  ///< by store: it is drawn
  std::string exportBase = "measurements";  ///< file name without its ending
};

/// What the user asked for in the panel; ViewerApp does it.
struct ToolsRequest {
  bool layersChanged = false;
  bool pictureChanged = false;  ///< something else was changed that the picture shows
  bool exportCsv = false, exportGeoJson = false;
  bool saveProject = false;
  bool addBookmark = false;
  std::optional<View> goTo;
  std::optional<std::size_t> showProfile;  ///< index among the measurements
};

/// Draws the panel "Tools" at the right edge of the window, which `view` fills; between Window::beginFrame() and
/// finishFrame(). `bounds` is the box of the scan.
ToolsRequest drawToolsPanel(ToolsState& state, const View& view, const Box& bounds);

/// Draws lines, points and results of the measurements, and a ring around the picked point, over the picture.
void drawMeasurements(const MeasureTool& tool, const View& view, const std::optional<PickedPoint>& picked);

}  // namespace strata
