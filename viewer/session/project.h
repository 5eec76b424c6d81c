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

/// A view with a name, to come back to.
struct Bookmark {
  std::string name;
  View view;

  bool operator==(const Bookmark&) const = default;
};

/// What strata-view keeps between two sessions, as a JSON file.
struct Project {
  std::vector<std::string> stores;  ///< in the file relative to it where they can be, so that a folder can move
  std::vector<bool> shown;          ///< by store
  View view;
  DrawOptions draw;  ///< but for its clip
  std::vector<ClipBox> clipBoxes;
  std::uint64_t pointBudget = SelectionOptions{}.pointBudget;
  double pointsPerPixel = SelectionOptions{}.pointsPerPixel;
  std::vector<Bookmark> bookmarks;
  std::vector<Measurement> measurements;
  std::optional<CameraPath> path;  ///< where one has been made
};

/// The text of the file at `path`, and back. Settings that are absent keep their defaults; parseProject throws Error
/// naming `path` and what is wrong.
std::string projectJson(const std::string& path, const Project& project);
Project parseProject(const std::string& path, const std::string& json);

}  // namespace strata
