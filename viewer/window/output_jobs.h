#pragma once
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "viewer/output/film_taker.h"
#include "viewer/output/picture_taker.h"
#include "viewer/window/output_panel.h"

namespace strata {

/// What the picture on the screen is drawn from and with; pictures and films are made of the same.
struct OutputSource {
  Layers& layers;
  Rasterizer& rasterizer;
  const DrawOptions& draw;
  const SelectionOptions& selection;
  const std::string& firstStore;  ///< path
};

/// What strata-view makes to be kept beside the project: pictures, camera paths, films. Lives on the render thread.
class OutputJobs {
 public:
  /// Of the command line and of keys.
  OutputState& state() { return state_; }

  /// Draws the window for pictures and paths and does what is asked for there. Where the camera is to go, if it is.
  std::optional<View> draw(const View& view, const OutputSource& source);

  /// A picture or a film is being drawn: the layers and the rasterizer are in use.
  bool working() const { return !std::holds_alternative<std::monostate>(work_); }
  /// Does a little of it and shows how far it is. Ends it where `cancel` or the user says so.
  void goOn(const OutputSource& source, bool cancel);

  /// The path as it is, for the project; nothing where it has no key.
  std::optional<CameraPath> path(const View& view) const;
  void setPath(const CameraPath& path);
  /// As JSON, for strata-bench.
  void savePath(const View& view, const OutputSource& source);
  void startPicture(const View& view, const OutputSource& source);
  void startFilm(const View& view, const OutputSource& source);

  /// Keys and recording, with the camera as it is in this frame.
  void addKey(const View& view) { state_.path.addKey(view); }
  void toggleRecording(const View& view);
  void record(const View& view, double seconds) { state_.path.record(view, seconds); }
  /// From the beginning of the path; or stops.
  void togglePlaying();
  void stopPlaying() { state_.playing = false; }
  /// Where the camera is `seconds` later; nothing where no path is being played.
  std::optional<View> play(const View& view, double seconds);
  bool busy() const { return state_.playing || state_.path.recording() || working(); }

  /// What was done last, and what went wrong; empty each time after.
  std::string takeNotice() { return std::exchange(notice_, {}); }
  std::string takeError() { return std::exchange(error_, {}); }

 private:
  template <class Start>
  void start(const std::string& what, Start start);
  void endWork(const OutputSource& source);
  CameraPath pathOf(const View& view) const;
  void openPath();

  OutputState state_;
  std::variant<std::monostate, std::unique_ptr<PictureTaker>, std::unique_ptr<FilmTaker>> work_;
  std::string what_;
  std::chrono::steady_clock::time_point began_;
  double played_ = 0.0;  ///< seconds of the path
  std::string notice_, error_;
};

}  // namespace strata
