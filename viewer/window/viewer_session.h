#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/box.h"
#include "core/view.h"
#include "viewer/camera/camera_control.h"
#include "viewer/session/opened_stores.h"
#include "viewer/session/project.h"
#include "viewer/window/settings_panel.h"
#include "viewer/window/tools_panel.h"
#include "viewer/window/viewer_options.h"

namespace strata {

/// What the user has made of the scan so far. A project keeps all of it but the clip planes, and the camera path too.
struct ViewerSession {
  CameraControl camera;
  ViewerSettings settings{};
  ToolsState tools{};
  std::vector<glm::dvec4> clipPlanes{};  ///< of the command line
  /// Which stores are shown, by their index among the paths asked for. Stores that could not be opened keep what the
  /// project says of them.
  std::vector<bool> shownPaths{};
};

/// The session that the command line asks for. `view` sees all of the scan, which lies in `bounds`.
ViewerSession beginSession(const ViewerOptions& options, const OpenedStores& opened, View view, const Box& bounds);

/// Goes on where the session was left that `project` keeps.
void restoreSession(ViewerSession& session, const Project& project, const OpenedStores& opened);

/// The session as a project of the stores `paths`, with the camera path where there is one.
Project projectOf(const ViewerSession& session, const OpenedStores& opened, const std::vector<std::string>& paths,
                  const std::optional<CameraPath>& path);

/// Sets the clip and the classes that are drawn to those of the tools.
void applyTools(ViewerSession& session);

/// The ends of the sliders for `stores`. `draw` has the ranges of the command line.
ColourLimits colourLimits(const std::vector<std::shared_ptr<const Store>>& stores, const ViewerOptions& options,
                          const Box& bounds, const DrawOptions& draw);

}  // namespace strata
