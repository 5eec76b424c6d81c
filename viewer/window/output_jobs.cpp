#include "viewer/window/output_jobs.h"

#include <utility>

#include "core/error.h"
#include "io/file/text_file.h"

namespace strata {
namespace {

constexpr std::chrono::milliseconds kPatience{30};  // how long a frame of the progress waits for detail
constexpr double kLongestFlight = 1e5;              // seconds, so that a mistyped time does not play for ever

std::string shellQuoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string sizeText(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

}  // namespace

OutputJobs::OutputJobs(const std::string& name, Messages& messages) : messages_(messages) {
  state_.pathFile = name + ".path.json";
  state_.filmFile = name + ".mp4";
  state_.pictureFile = name + ".png";
}

void OutputJobs::use(const WindowInput& input, CameraControl& camera, const OutputSource& source) {
  if (input.has(Command::toggleOutputPanel)) state_.open = !state_.open;
  if (input.has(Command::takePicture)) startPicture(camera.view(), source);
  if (input.has(Command::addPathKey)) {
    state_.path.addKey(camera.view());
    messages_.notice = "key " + std::to_string(state_.path.keys().size()) + " of the camera path is set";
  }
  if (input.has(Command::toggleRecording)) toggleRecording(camera.view());
  if (input.has(Command::togglePlaying)) togglePlaying();
  const bool movedByUser = input.mouse.dragging || input.mouse.wheel != 0.0 || !input.fly.still() || camera.gliding();
  if (movedByUser) state_.playing = false;
  if (const auto view = play(camera.view(), input.seconds)) camera.setView(*view);
  state_.path.record(camera.view(), input.seconds);
}

std::optional<View> OutputJobs::drawPanel(const View& view, const OutputSource& source) {
  const OutputRequest request = drawOutputPanel(state_, view);
  if (request.savePath) savePath(view, source);
  if (request.openPath) openPath();
  if (request.record) toggleRecording(view);
  if (request.play) togglePlaying();
  if (request.takePicture) startPicture(view, source);
  if (request.takeFilm) startFilm(view, source);
  return request.goTo;
}

template <class Start>
void OutputJobs::start(const std::string& what, Start start) {
  state_.playing = false;
  state_.path.endRecording();
  what_ = what;
  began_ = std::chrono::steady_clock::now();
  try {
    start();
  } catch (const Error& error) {
    messages_.error = error.what();
  }
}

void OutputJobs::startPicture(const View& view, const OutputSource& source) {
  PictureOrder order{state_.pictureFile, view, source.draw, source.selection};
  order.view.width = state_.pictureWidth;
  order.view.height = state_.pictureHeight;
  if (state_.scalePoints) order.draw = scaledToPicture(source.draw, view.height, state_.pictureHeight);
  start(order.file + ", " + sizeText(order.view.width, order.view.height) + " pixels",
        [&] { work_ = std::make_unique<PictureTaker>(std::move(order), source.layers, source.rasterizer); });
}

void OutputJobs::startFilm(const View& view, const OutputSource& source) {
  if (state_.path.keys().empty()) return;
  FilmOrder order{state_.filmFile, pathOf(view), state_.filmWidth, state_.filmHeight,
                  scaledToPicture(source.draw, view.height, state_.filmHeight)};
  start(order.file + ", " + std::to_string(order.path.frames()) + " frames of " + sizeText(order.width, order.height),
        [&] { work_ = std::make_unique<FilmTaker>(std::move(order), source.layers, source.rasterizer); });
}

void OutputJobs::goOn(const OutputSource& source, bool cancel) {
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  bool done = false, failed = false;
  double share = 0.0;
  try {
    if (auto* picture = std::get_if<std::unique_ptr<PictureTaker>>(&work_)) {
      done = (*picture)->goOn(kPatience);
      share = (*picture)->progress();
      if (done && (*picture)->unfinishedParts() > 0)
        messages_.error = state_.pictureFile + ": " + std::to_string((*picture)->unfinishedParts()) +
                          " parts of it lack detail that could not be loaded";
    } else if (auto* film = std::get_if<std::unique_ptr<FilmTaker>>(&work_)) {
      done = (*film)->goOn(kPatience);
      share = (*film)->progress();
    }
  } catch (const Error& error) {
    messages_.error = error.what();
    failed = true;
  }
  cancel = drawWorkProgress(what_, share, seconds) || cancel;
  if (done)
    messages_.notice = "saved " + what_;
  else if (cancel && !failed)
    messages_.notice = "given up: " + what_;
  if (!done && !cancel && !failed) return;
  work_ = std::monostate{};
  source.layers.setSelection(source.selection);
}

CameraPath OutputJobs::pathOf(const View& view) const {
  CameraPath path = state_.path.path(view.fovY, state_.fps);
  path.speed = state_.speed;
  return path;
}

std::optional<CameraPath> OutputJobs::path(const View& view) const {
  if (state_.path.keys().empty()) return std::nullopt;
  return pathOf(view);
}

void OutputJobs::setPath(const CameraPath& path) {
  state_.path.setKeys(path.keys);
  state_.fps = path.fps;
  state_.speed = path.speed;
}

void OutputJobs::toggleRecording(const View& view) {
  if (state_.path.recording()) {
    state_.path.endRecording();
    messages_.notice = "the path has " + std::to_string(state_.path.keys().size()) + " keys";
  } else {
    state_.playing = false;
    state_.path.beginRecording(view);
    messages_.notice = "recording the camera, R ends it";
  }
}

void OutputJobs::togglePlaying() {
  state_.path.endRecording();
  state_.playing = !state_.playing && !state_.path.keys().empty();
  played_ = 0.0;
}

std::optional<View> OutputJobs::play(const View& view, double seconds) {
  if (!state_.playing) return std::nullopt;
  const CameraPath path = pathOf(view);
  View next = viewAt(path, PathClock(path).keyTime(path.keys.front().t + played_), view.width, view.height);
  next.nearPlane = view.nearPlane;
  if (played_ >= path.duration()) state_.playing = false;
  played_ += seconds;
  return next;
}

void OutputJobs::savePath(const View& view, const OutputSource& source) {
  if (state_.path.keys().empty()) {
    messages_.error = "there is no path yet: K sets a key, R records";
    return;
  }
  if (state_.path.keys().back().t > kLongestFlight) {
    messages_.error =
        state_.pathFile + ": the path is too long, found " + std::to_string(state_.path.keys().back().t) + " s";
    return;
  }
  try {
    writeText(state_.pathFile, cameraPathJson(pathOf(view)));
    messages_.notice = "saved " + state_.pathFile;
    state_.benchCommand = "strata-bench " + shellQuoted(source.firstStore) + " --path " + shellQuoted(state_.pathFile) +
                          " -o " + shellQuoted(state_.pathFile + ".bench");
  } catch (const Error& error) {
    messages_.error = error.what();
  }
}

void OutputJobs::openPath() {
  try {
    const CameraPath path = readCameraPath(state_.pathFile);
    setPath(path);
    messages_.notice = "opened " + state_.pathFile + ", " + std::to_string(path.keys.size()) + " keys";
  } catch (const Error& error) {
    messages_.error = error.what();
  }
}

}  // namespace strata
