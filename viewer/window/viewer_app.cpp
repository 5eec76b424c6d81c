#include "viewer/window/viewer_app.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/image.h"
#include "core/log.h"
#include "io/file/text_file.h"
#include "viewer/camera/camera_control.h"
#include "viewer/camera/stills.h"
#include "viewer/output/picture_taker.h"
#include "viewer/session/opened_stores.h"
#include "viewer/session/picture_size.h"
#include "viewer/session/project.h"
#include "viewer/window/conversion_window.h"
#include "viewer/window/filter_panel.h"
#include "viewer/window/inspector_panel.h"
#include "viewer/window/layer_renderer.h"
#include "viewer/window/messages.h"
#include "viewer/window/output_jobs.h"
#include "viewer/window/overlay.h"
#include "viewer/window/profile_panel.h"
#include "viewer/window/progressive_panel.h"
#include "viewer/window/settings_panel.h"
#include "viewer/window/state_file.h"
#include "viewer/window/tool_input.h"
#include "viewer/window/tools_panel.h"
#include "viewer/window/viewer_session.h"
#include "viewer/window/window.h"

namespace strata {
namespace {

constexpr std::chrono::milliseconds kLongestWait{120'000};  // for the full detail of a screenshot
constexpr double kIdleWait = 0.25;                          // seconds between frames in which nothing happens
constexpr int kPanelFrames = 2;                             // a panel knows its size only in its second frame
constexpr std::uint32_t kPointedColour = 0xffffc840u;

/// The window of strata-view and what belongs to it. One frame: events, tools, picture, panels.
class ViewerApp {
 public:
  explicit ViewerApp(const ViewerOptions& options)
      : options_(options),
        opened_(openStores(options.stores)),
        scan_(sampleStores(opened_.stores)),
        window_("Strata – " + layerNames(options.stores), options.size.width, options.size.height,
                options.screenshot.empty() && options.picture.empty()),
        renderer_(opened_.stores, options, Window::getProc()),
        session_(beginSession(options, opened_, overviewStill(scan_, options.size.width, options.size.height).view,
                              scan_.bounds)),
        limits_(colourLimits(opened_.stores, options, scan_.bounds, session_.settings.draw)),
        outputJobs_(layerNames({options.stores.front()}), messages_),
        profilePanel_(Window::getProc()),
        inspector_(Window::getProc()),
        stateFile_(options.state) {
    for (const auto& store : opened_.stores) pointsInStores_ += store->info().points;
    for (const std::string& layer : session_.tools.layers) layerNames_ += (layerNames_.empty() ? "" : ", ") + layer;
    messages_.error = opened_.failures;
    applySelection();
  }

  void restore(const Project& project) {
    restoreSession(session_, project, opened_);
    if (project.path) outputJobs_.setPath(*project.path);
    measurementsSeen_ = project.measurements.size();
    renderer_.layers().setShown(session_.tools.shown);
    applySelection();
  }

  /// Shows frame after frame until the window is closed.
  void run() {
    for (bool idle = false; !window_.closed();) {
      const WindowInput input = window_.beginFrame(idle ? kIdleWait : 0.0);
      bool settled = false;
      if (outputJobs_.drawing()) {
        showProgress(input);
      } else if (input.hidden) {
        window_.finishFrame();
        settled = true;
      } else {
        settled = showFrame(input);
      }
      writeState(input, settled);
      idle = settled || input.hidden;
    }
  }

  /// Writes the whole window to a PNG file, with the picture in full detail.
  void screenshot(const std::string& file) {
    WindowInput input;
    bool uploading = true;
    for (int i = 0; i < kPanelFrames || uploading; ++i) {
      input = window_.beginFrame(0.0);
      session_.camera.resize(input.width, input.height);
      renderer_.layers().setView(session_.camera.view());
      renderer_.layers().waitUntilComplete(kLongestWait);
      drawPicture(input);
      drawPanels(input);
      window_.finishFrame();
      uploading = !isFinished(renderer_.report().draw);
    }
    writePng(file, renderer_.texture().readBackBuffer(input.width, input.height));
  }

  /// Writes the picture alone to a PNG file, in any size and in full detail.
  void picture(const std::string& file, const PictureSize& size) {
    View view = session_.camera.view();
    view.width = size.width;
    view.height = size.height;
    const DrawOptions draw = scaledToPicture(session_.settings.draw, options_.size.height, size.height);
    PictureTaker taker({file, view, draw, session_.settings.selection}, renderer_.layers(), renderer_.rasterizer());
    while (!taker.goOn(kLongestWait)) {
    }
    if (taker.unfinishedParts() > 0)
      logWarning(file + ": " + std::to_string(taker.unfinishedParts()) + " parts lack detail that could not be loaded");
  }

 private:
  /// One frame. True when nothing will change until the user does something.
  bool showFrame(const WindowInput& input) {
    steer(session_.camera, session_.tools, input, onScreen());
    if (input.has(Command::toggleHelp)) helpOpen_ = !helpOpen_;
    if (input.has(Command::saveProject)) saveProject();
    const std::string error = toolInput_.use(session_.tools, input, session_.camera.view(), onScreen());
    if (!error.empty()) messages_.error = error;
    outputJobs_.use(input, session_.camera, outputSource());
    drawPicture(input);
    const bool changed = drawPanels(input);
    window_.finishFrame();
    window_.present();
    return input.idle() && !changed && renderer_.report().complete && isFinished(renderer_.report().draw) &&
           !session_.camera.gliding() && !toolInput_.busy() && !profilePanel_.reading() && !window_.panelInUse() &&
           !outputJobs_.busy();
  }

  /// One frame while a picture or a film is being drawn into a file: its progress, over the newest picture.
  void showProgress(const WindowInput& input) {
    if (!input.hidden) window_.drawPicture(renderer_.texture().id());
    outputJobs_.goOn(outputSource(), input.has(Command::cancel));
    drawError(messages_.error);
    window_.finishFrame();
    if (!input.hidden) window_.present();
  }

  void drawPicture(const WindowInput& input) {
    session_.camera.resize(input.width, input.height);
    applyTools(session_);
    const View& view = session_.camera.view();
    renderer_.draw(view, inspector_.chosenFor(view), session_.settings.draw);
    window_.drawPicture(renderer_.texture().id());
    ClassCensus& census = session_.tools.census;
    const RenderList& list = *renderer_.list();
    for (std::size_t i = 0; i < list.items.size(); ++i)
      census.add(renderer_.layers().indexOfItem(i), *list.items[i].node);
    limits_.classes = census.present();
    reportDamage();
  }

  /// Everything over the picture. True when something was changed that the picture shows.
  bool drawPanels(const WindowInput& input) {
    drawOverlays(input);
    bool changed = drawSettings(input);
    if (auto* progressive = renderer_.progressive()) changed = drawProgressivePanel(*progressive) || changed;
    const ToolsRequest request = drawToolsPanel(session_.tools, session_.camera.view(), scan_.bounds);
    changed = carryOut(request) || changed;
    drawProfile(request.showProfile);
    if (const auto view = outputJobs_.drawPanel(session_.camera.view(), outputSource())) {
      session_.camera.glideTo(*view);
      changed = true;
    }
    drawHelp(helpOpen_);
    drawError(messages_.error);
    return changed;
  }

  void drawOverlays(const WindowInput& input) {
    const View& view = session_.camera.view();
    drawClipBoxes(session_.tools.clip, view);
    drawMeasurements(session_.tools.measure, view, session_.tools.picked);
    inspector_.drawOver(renderer_.layers(), *renderer_.list(), view);
    if (!renderer_.report().complete) drawSpinner();
    drawHint(session_.tools.measure.hint());
    if (!input.fly.still() || session_.camera.mode() == MoveMode::fly) drawFlySpeed(flySpeed(view, input.fly.fast));
  }

  bool drawSettings(const WindowInput& input) {
    ViewerSettings& settings = session_.settings;
    View view = session_.camera.view();
    settings.fovY = view.fovY;
    const bool changed = drawSettingsPanel(settings, limits_,
                                           {.layers = layerNames_,
                                            .pointsInStores = pointsInStores_,
                                            .rasterizer = renderer_.rasterizerName(),
                                            .progressive = renderer_.progressive() != nullptr,
                                            .frame = renderer_.report(),
                                            .mode = session_.camera.mode(),
                                            .flySpeed = flySpeed(view, input.fly.fast),
                                            .notice = messages_.notice},
                                           inspector_);
    if (settings.fovY != view.fovY) {
      view.fovY = settings.fovY;
      session_.camera.setView(view);
    }
    try {
      renderer_.switchTo(settings.backend);
    } catch (const Error& error) {
      messages_.error = error.what();
      settings.backend = renderer_.backend();
    }
    // Not only this panel changes what is to be loaded: classes are hidden and clip boxes moved elsewhere.
    if (changed || shownBy(settings.draw) != settings.selection.shown) applySelection();
    return changed;
  }

  bool carryOut(const ToolsRequest& request) {
    ToolsState& tools = session_.tools;
    const View& view = session_.camera.view();
    if (request.layersChanged) renderer_.layers().setShown(tools.shown);
    if (request.goTo) session_.camera.glideTo(*request.goTo);
    if (request.addBookmark) tools.bookmarks.push_back({"view " + std::to_string(tools.bookmarks.size() + 1), view});
    const std::vector<Measurement>& kept = tools.measure.kept();
    if (request.exportCsv) save(tools.exportBase + ".csv", measurementsCsv(kept));
    if (request.exportGeoJson)
      save(tools.exportBase + ".geojson", measurementsGeoJson(kept, opened_.stores.front()->info().crs));
    if (request.saveProject) saveProject();
    return request.layersChanged || request.pictureChanged || request.goTo;
  }

  /// The window of the profile `asked`, an index among the measurements. A profile that was just made opens it too.
  void drawProfile(std::optional<std::size_t> asked) {
    std::vector<Measurement>& kept = session_.tools.measure.kept();
    if (kept.size() > measurementsSeen_ && kept.back().kind == MeasureKind::profile) asked = kept.size() - 1;
    measurementsSeen_ = kept.size();
    if (asked && *asked < kept.size()) profilePanel_.show(kept[*asked]);
    std::vector<std::shared_ptr<const Store>> shown;
    for (std::size_t i = 0; i < opened_.stores.size(); ++i)
      if (session_.tools.shown[i]) shown.push_back(opened_.stores[i]);
    const ProfilePanel::Outcome outcome = profilePanel_.draw(kept, shown, session_.settings.draw);
    if (outcome.pointed) overlayRing(session_.camera.view(), *outcome.pointed, kPointedColour, 8.0f);
    if (!outcome.csv.empty()) save(fileNameOf(outcome.name) + ".csv", outcome.csv);
    if (!outcome.failure.empty()) messages_.error = outcome.failure;
  }

  /// Names the layers of which nodes cannot be read, once for each number of them.
  void reportDamage() {
    const std::uint64_t givenUp = renderer_.report().streamer.nodesGivenUp;
    if (std::exchange(nodesGivenUp_, givenUp) == givenUp) return;
    messages_.error.clear();
    for (std::size_t i = 0; i < opened_.stores.size(); ++i)
      if (const std::uint64_t lost = renderer_.layers().statsOf(i).nodesGivenUp; lost > 0)
        messages_.error += (messages_.error.empty() ? "" : "\n") + session_.tools.layers[i] + ": " +
                           std::to_string(lost) +
                           " of the nodes seen so far cannot be read and are left out; the rest is shown";
  }

  void save(const std::string& file, const std::string& text) {
    try {
      writeText(file, text);
      messages_.notice = "saved " + file;
    } catch (const Error& error) {
      messages_.error = error.what();
    }
  }

  void saveProject() {
    const View& view = session_.camera.view();
    const std::string file =
        options_.project.empty() ? session_.tools.layers.front() + ".project.json" : options_.project;
    const std::optional<CameraPath> path = outputJobs_.path(view);
    save(file, projectJson(file, projectOf(session_, opened_, options_.stores, path)));
    if (path) outputJobs_.savePath(view, outputSource());
  }

  /// What is loaded follows from what is drawn.
  void applySelection() {
    session_.settings.selection.shown = shownBy(session_.settings.draw);
    renderer_.layers().setSelection(session_.settings.selection);
  }

  ScreenContent onScreen() { return {renderer_.layers(), renderer_.list(), renderer_.picture(), scan_.bounds}; }

  OutputSource outputSource() {
    return {renderer_.layers(), renderer_.rasterizer(), session_.settings.draw, session_.settings.selection,
            options_.stores.front()};
  }

  void writeState(const WindowInput& input, bool settled) {
    if (options_.state.empty()) return;
    const ToolsState& tools = session_.tools;
    const OutputState& output = outputJobs_.state();
    stateFile_.write(
        window_, {.settled = settled,
                  .hidden = input.hidden,
                  .size = {input.width, input.height},
                  .eye = session_.camera.view().eye,
                  .moving = modeName(session_.camera.mode()),
                  .measuring = tools.measure.active() ? static_cast<int>(tools.measure.current()->points.size()) : -1,
                  .measured = tools.measure.kept().size(),
                  .clipBoxes = tools.clip.boxes().size(),
                  .hiddenClasses = tools.classes.size() - tools.classes.count(),
                  .pathKeys = output.path.keys().size(),
                  .recording = output.path.recording(),
                  .playing = output.playing,
                  .working = outputJobs_.drawing(),
                  .drawn = renderer_.report().framesDrawn,
                  .picked = tools.picked ? tools.picked->coordinates : std::string(),
                  .notice = messages_.notice,
                  .error = messages_.error});
  }

  const ViewerOptions options_;
  const OpenedStores opened_;
  const ScanSample scan_;
  std::uint64_t pointsInStores_ = 0;
  std::string layerNames_;

  // The rest is used by the render thread only. The window comes first: its context outlives all that OpenGL holds.
  Window window_;
  LayerRenderer renderer_;
  ViewerSession session_;
  ColourLimits limits_;
  Messages messages_;
  ToolInput toolInput_;
  OutputJobs outputJobs_;
  ProfilePanel profilePanel_;
  InspectorPanel inspector_;
  StateFile stateFile_;
  std::uint64_t nodesGivenUp_ = 0;    ///< of which the user was told
  std::size_t measurementsSeen_ = 0;  ///< that were kept in the last frame
  bool helpOpen_ = false;
};

/// The project that `options` name instead of stores; its stores take the project's place there.
std::optional<Project> openProject(ViewerOptions& options) {
  const std::string path = options.stores.front();
  if (options.stores.size() != 1 || !path.ends_with(".json") || !std::filesystem::is_regular_file(path))
    return std::nullopt;
  Project project = parseProject(path, readText(path));
  options.project = path;
  options.stores = project.stores;
  return project;
}

}  // namespace

void runViewer(const ViewerOptions& asked) {
  ViewerOptions options = asked;
  const std::optional<Project> project = openProject(options);
  if (!convertScans(options)) return;
  ViewerApp app(options);
  if (project) app.restore(*project);
  if (!options.screenshot.empty()) app.screenshot(options.screenshot);
  if (!options.picture.empty()) app.picture(options.picture, options.pictureSize);
  if (options.screenshot.empty() && options.picture.empty()) app.run();
}

}  // namespace strata
