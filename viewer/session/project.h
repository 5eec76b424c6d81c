#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/draw_options.h"
#include "core/view.h"
#include "lod/selection.h"
#include "viewer/camera/camera_path.h"
#include "viewer/tools/clip_boxes.h"
#include "viewer/tools/measurement.h"

namespace strata {

/// A view with a name, to which the user can return.
struct Bookmark {
  std::string name;
  View view;

  bool operator==(const Bookmark&) const = default;
};

/// The state that strata-view keeps between two sessions, as a JSON file.
struct Project {
  std::vector<std::string> stores;  ///< relative to the file if possible, so that the folder can move
  std::vector<bool> shown;          ///< by store
  View view;
  DrawOptions draw;  ///< without its clip
  std::vector<ClipBox> clipBoxes;
  std::uint64_t pointBudget = SelectionOptions{}.pointBudget;
  double pointsPerPixel = SelectionOptions{}.pointsPerPixel;
  std::vector<Bookmark> bookmarks;
  std::vector<Measurement> measurements;
  std::optional<CameraPath> path;  ///< nothing until one has been made
};

/// The text of the file at `path`, and back. Settings that are absent keep their defaults; parseProject throws Error
/// naming `path` and what is wrong.
std::string projectJson(const std::string& path, const Project& project);
Project parseProject(const std::string& path, const std::string& json);

}  // namespace strata
