#include "viewer/window/viewer_app.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "core/error.h"
#include "core/image.h"
#include "core/log.h"
#include "io/file/text_file.h"
#include "render/create_rasterizer.h"
#include "viewer/camera/camera_control.h"
#include "viewer/camera/scan_sample.h"
#include "viewer/camera/stills.h"
#include "viewer/session/layers.h"
#include "viewer/session/opened_stores.h"
#include "viewer/session/project.h"
#include "viewer/window/filter_panel.h"
#include "viewer/window/inspector_panel.h"
#include "viewer/window/measure_panel.h"
#include "viewer/window/output_jobs.h"
#include "viewer/window/overlay.h"
#include "viewer/window/panel.h"
#include "viewer/window/picture_texture.h"
#include "viewer/window/profile_panel.h"
#include "viewer/window/progressive_panel.h"
#include "viewer/window/scan_conversion.h"
#include "viewer/window/state_file.h"
#include "viewer/window/tool_input.h"
#include "viewer/window/window.h"

namespace strata {
namespace {

constexpr std::chrono::milliseconds kLongestWait{120'000};  // for a screenshot's full detail
constexpr double kIdleWait = 0.25;                          // seconds between frames where nothing happens
constexpr double kNearShare = 1e-5;  // of the scan's diagonal: how near the eye may come to something small
constexpr int kPanelFrames = 2;
constexpr std::uint32_t kPointedColour = 0xffffc840u;
constexpr double kSmoothing = 0.1;  // share of the newest frame in the frame time shown

glm::vec2 intensityLimits(const AttributeRange& range) {
  return {static_cast<float>(range.min), static_cast<float>(std::max(range.max, range.min + 1.0))};
}

/// The rasterizer that the command line asks for, which draws with the window's context.
std::unique_ptr<Rasterizer> createWindowRasterizer(const ViewerOptions& options, const Layers& layers) {
  std::uint64_t points = 0;
  for (const auto& store : layers.stores()) points += store->info().points;
  return createRasterizerFor(options.backend,
                             progressiveOptions(options.progressive, options.streamer.selection.pointBudget, points),
                             adoptCurrentContext(Window::getProc()));
}

class ViewerApp {
 public:
  explicit ViewerApp(const ViewerOptions& options)
      : options_(options),
        opened_(openStores(options.stores)),
        layers_(opened_.stores, options.streamer),
        scene_(surveyStores(layers_.stores())),
        window_("Strata – " + layerNames(options.stores), options.size.width, options.size.height,
                options.screenshot.empty() && options.picture.empty()),
        texture_(Window::getProc()),
        profile_(Window::getProc()),
        inspector_(Window::getProc()),
        stateFile_(options.state),
        rasterizer_(createWindowRasterizer(options, layers_)),
        progressive_(dynamic_cast<ProgressiveRasterizer*>(rasterizer_.get())),
        control_(overviewStill(scene_, options.size.width, options.size.height).view) {
    View first = control_.view();
    first.nearPlane = std::min(first.nearPlane, kNearShare * scene_.bounds.diagonal());
    control_.setView(first);
    outputJobs_.state().pathFile = layerNames({options.stores.front()}) + ".path.json";
    outputJobs_.state().filmFile = layerNames({options.stores.front()}) + ".mp4";
    outputJobs_.state().pictureFile = layerNames({options.stores.front()}) + ".png";
    settings_.selection = options.streamer.selection;
    settings_.draw = drawOptionsFor(layers_.stores().front()->info(), scene_.bounds, options.colour);
    applyDrawFlags(options.draw, settings_.draw);
    select();
    settings_.draw.pointSize = options.pointSize;
    settings_.draw.edl = options.edl;
    settings_.backend = options.backend;
    backend_ = options.backend;
    stats_.rasterizer = std::string(rasterizer_->name()) + ", " + rasterizer_->device();
    stats_.progressive = progressive_ != nullptr;
    stats_.error = opened_.failures;
    for (const std::size_t i : opened_.asked) tools_.layers.push_back(layerNames({options.stores[i]}));
    tools_.shown.assign(opened_.asked.size(), true);
    lostShown_.assign(options.stores.size(), true);
    limits_.elevation = settings_.draw.elevationRange;
    limits_.automatic = drawOptionsFor(layers_.stores().front()->info(), scene_.bounds, options.colour);
    for (const auto& store : layers_.stores()) {
      stats_.pointsInStores += store->info().points;
      stats_.layers += (stats_.layers.empty() ? "" : ", ") +
                       tools_.layers[static_cast<std::size_t>(&store - layers_.stores().data())];
      limits_.levels = std::max(limits_.levels, store->info().levels);
      const int intensity = store->info().layout.find(attribute::kIntensity);
      if (intensity >= 0)
        limits_.intensity = intensityLimits(store->info().ranges[static_cast<std::size_t>(intensity)]);
    }
    tools_.classes = settings_.draw.classes;
    planes_ = settings_.draw.clip.planes;
    for (const Box& box : settings_.draw.clip.boxes) tools_.clip.add(box);
  }

  /// Goes on where a session was left.
  void restore(const Project& project) {
    settings_.draw = project.draw;
    settings_.selection.pointBudget = project.pointBudget;
    settings_.selection.pointsPerPixel = project.pointsPerPixel;
    lostShown_ = project.shown;
    for (std::size_t i = 0; i < opened_.asked.size(); ++i) tools_.shown[i] = project.shown[opened_.asked[i]];
    tools_.bookmarks = project.bookmarks;
    tools_.classes = project.draw.classes;
    tools_.clip.boxes() = project.clipBoxes;
    tools_.measure.kept() = project.measurements;
    keptBefore_ = project.measurements.size();
    if (project.path) outputJobs_.setPath(*project.path);
    control_.setView(project.view);
    select();
    layers_.setShown(tools_.shown);
  }

  void run() {
    bool idle = false;
    while (!window_.closed()) {
      const WindowInput input = window_.beginFrame(idle ? kIdleWait : 0.0);
      if (outputJobs_.working()) {
        work(input);
        idle = input.hidden;
        sayState(input, false);
        continue;
      }
      if (input.hidden) {
        window_.finishFrame();
        idle = true;
        sayState(input, true);
        continue;
      }
      steer(control_, tools_, input, seen());
      stats_.mode = control_.mode();
      stats_.flySpeed = flySpeed(control_.view(), input.fly.fast);
      stats_.flying = !input.fly.still() || control_.mode() == MoveMode::fly;
      if (input.help) helpOpen_ = !helpOpen_;
      if (input.save) saveProject();
      if (const std::string error = toolInput_.use(tools_, input, control_.view(), seen()); !error.empty())
        stats_.error = error;
      useOutputKeys(input);
      drawFrame(input.width, input.height);
      const bool changed = drawOver();
      window_.finishFrame();
      window_.present();
      idle = input.idle() && !changed && stats_.complete && isFinished(stats_.draw) && !control_.gliding() &&
             !toolInput_.busy() && !profile_.reading() && !window_.panelInUse() && !outputJobs_.busy();
      sayState(input, idle);
    }
  }

  void screenshot(const std::string& file) {
    WindowInput input;
    bool uploading = true;
    // The panel knows its size only in its second frame.
    for (int i = 0; i < kPanelFrames || uploading; ++i) {
      input = window_.beginFrame(0.0);
      control_.resize(input.width, input.height);
      layers_.setView(control_.view());
      layers_.waitUntilComplete(kLongestWait);
      drawFrame(input.width, input.height);
      drawOver();
      window_.finishFrame();
      uploading = !isFinished(stats_.draw);
    }
    writePng(file, texture_.readBackBuffer(input.width, input.height));
  }

  /// The scene alone, in any size.
  void picture(const std::string& file, const PictureSize& size) {
    View view = control_.view();
    view.width = size.width;
    view.height = size.height;
    const DrawOptions draw = scaledToPicture(settings_.draw, options_.size.height, size.height);
    PictureTaker taker({file, view, draw, settings_.selection}, layers_, *rasterizer_);
    while (!taker.goOn(kLongestWait)) {
    }
    if (taker.unfinishedParts() > 0)
      logWarning(file + ": " + std::to_string(taker.unfinishedParts()) + " parts lack detail that could not be had");
  }

 private:
  void sayState(const WindowInput& input, bool settled) {
    if (options_.state.empty()) return;
    const std::optional<Measurement>& current = tools_.measure.current();
    stateFile_.write(window_, {.settled = settled,
                               .hidden = input.hidden,
                               .size = {input.width, input.height},
                               .eye = control_.view().eye,
                               .moving = modeName(control_.mode()),
                               .measuring = current ? static_cast<int>(current->points.size()) : -1,
                               .measured = tools_.measure.kept().size(),
                               .clipBoxes = tools_.clip.boxes().size(),
                               .hiddenClasses = tools_.classes.size() - tools_.classes.count(),
                               .pathKeys = outputJobs_.state().path.keys().size(),
                               .recording = outputJobs_.state().path.recording(),
                               .playing = outputJobs_.state().playing,
                               .working = outputJobs_.working(),
                               .drawn = framesDrawn_,
                               .picked = tools_.picked ? tools_.picked->coordinates : std::string(),
                               .notice = stats_.notice,
                               .error = stats_.error});
  }

  OutputSource outputSource() {
    return {layers_, *rasterizer_, settings_.draw, settings_.selection, options_.stores.front()};
  }

  /// A frame of the progress while a picture or a film is being drawn; behind it stands the newest frame.
  void work(const WindowInput& input) {
    if (!input.hidden) window_.drawPicture(texture_.id());
    outputJobs_.goOn(outputSource(), input.drop);
    tell();
    drawError(stats_.error);
    window_.finishFrame();
    if (!input.hidden) window_.present();
  }

  void tell() {
    if (const std::string notice = outputJobs_.takeNotice(); !notice.empty()) stats_.notice = notice;
    if (const std::string error = outputJobs_.takeError(); !error.empty()) stats_.error = error;
  }

  /// Keys of camera paths, and the path that is being recorded or played.
  void useOutputKeys(const WindowInput& input) {
    OutputState& state = outputJobs_.state();
    if (input.pictures) state.open = !state.open;
    if (input.takePicture) outputJobs_.startPicture(control_.view(), outputSource());
    if (input.pathKey) {
      outputJobs_.addKey(control_.view());
      stats_.notice = "key " + std::to_string(state.path.keys().size()) + " of the camera path is set";
    }
    if (input.record) outputJobs_.toggleRecording(control_.view());
    if (input.play) outputJobs_.togglePlaying();
    const bool handOn = input.dragging || input.wheel != 0.0 || !input.fly.still() || control_.gliding();
    if (handOn) outputJobs_.stopPlaying();
    if (const auto view = outputJobs_.play(control_.view(), input.seconds)) control_.setView(*view);
    outputJobs_.record(control_.view(), input.seconds);
  }

  /// What is on the screen, which the hand means.
  ScreenContent seen() const { return {layers_, list_, picture_, scene_.bounds}; }

  void drawFrame(int width, int height) {
    control_.resize(width, height);
    const auto start = std::chrono::steady_clock::now();
    const View ahead = motion_.ahead(control_.view(), start);
    const View& chosenFor = inspector_.chosenFor(control_.view());
    layers_.setView(chosenFor, chosenFor == control_.view() ? ahead : chosenFor);
    const RenderList& list = layers_.beginFrame();
    list_ = &list;
    for (std::size_t i = 0; i < list.items.size(); ++i) tools_.census.add(layers_.indexOfItem(i), *list.items[i].node);
    settings_.draw.clip = clipOf(tools_.clip.boxes(), planes_);
    settings_.draw.classes = tools_.classes;
    stats_.draw = rasterizer_->draw(list, control_.view(), settings_.draw, picture_);
    ++framesDrawn_;
    texture_.upload(picture_);
    window_.drawPicture(texture_.id());
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    stats_.frameMs = stats_.frameMs == 0.0 ? ms : stats_.frameMs + kSmoothing * (ms - stats_.frameMs);
    stats_.missingNodes = list.missingNodes;
    stats_.complete = layers_.complete();
    stats_.streamer = layers_.stats();
    stats_.nodesDrawn = list.items.size();
    stats_.history.add(start, {ms, stats_.draw.pointsDrawn, list.items.size(), list.missingNodes}, stats_.streamer);
    limits_.classes = tools_.census.present();
    sayDamage();
  }

  /// Names the layers of which nodes were given up, once for each number of them.
  void sayDamage() {
    if (stats_.streamer.nodesGivenUp == damageSaid_) return;
    damageSaid_ = stats_.streamer.nodesGivenUp;
    stats_.error.clear();
    for (std::size_t i = 0; i < layers_.stores().size(); ++i)
      if (const std::uint64_t lost = layers_.statsOf(i).nodesGivenUp; lost > 0)
        stats_.error += (stats_.error.empty() ? "" : "\n") + tools_.layers[i] + ": " + std::to_string(lost) +
                        " of the nodes seen so far cannot be read and are left out; the rest is shown";
  }

  /// Takes another rasterizer where one was chosen; one that cannot work here is refused and the old one stays.
  void switchBackend() {
    if (settings_.backend == backend_) return;
    try {
      rasterizer_ = createRasterizer(settings_.backend, {}, adoptCurrentContext(Window::getProc()));
      progressive_ = nullptr;
      stats_.progressive = false;
      backend_ = settings_.backend;
      stats_.rasterizer = std::string(rasterizer_->name()) + ", " + rasterizer_->device();
    } catch (const Error& error) {
      stats_.error = error.what();
      settings_.backend = backend_;
    }
  }

  /// What is loaded follows from what is drawn.
  void select() {
    followDrawing(settings_.draw, settings_.selection);
    layers_.setSelection(settings_.selection);
  }

  bool drawSettingsPanel() {
    settings_.fovY = control_.view().fovY;
    const bool changed = drawPanel(settings_, stats_, limits_, [this] { inspector_.drawSection(stats_.nodesDrawn); });
    if (!changed) return false;
    if (settings_.fovY != control_.view().fovY) {
      View view = control_.view();
      view.fovY = settings_.fovY;
      control_.setView(view);
    }
    switchBackend();
    select();
    return true;
  }

  /// Measurements, panels and messages. True when something was changed that the picture shows.
  bool drawOver() {
    drawClipBoxes(tools_.clip, control_.view());
    drawMeasurements(tools_.measure, control_.view(), tools_.picked);
    if (list_ != nullptr) inspector_.drawOver(layers_, *list_, control_.view());
    drawSpinner(stats_);
    drawHint(tools_.measure.hint());
    drawFlySpeed(stats_);
    bool changed = drawSettingsPanel();
    if (followDrawing(settings_.draw, settings_.selection)) select();  // classes hidden, a clip box moved
    if (progressive_ != nullptr) changed = drawProgressivePanel(*progressive_) || changed;
    const ToolsRequest request = drawToolsPanel(tools_, control_.view(), scene_.bounds);
    if (request.layersChanged) layers_.setShown(tools_.shown);
    if (request.goTo) control_.glideTo(*request.goTo);
    if (request.addBookmark)
      tools_.bookmarks.push_back({"view " + std::to_string(tools_.bookmarks.size() + 1), control_.view()});
    const std::vector<Measurement>& kept = tools_.measure.kept();
    if (request.exportCsv) save(tools_.exportBase + ".csv", measurementsCsv(kept));
    if (request.exportGeoJson)
      save(tools_.exportBase + ".geojson", measurementsGeoJson(kept, layers_.stores().front()->info().crs));
    if (request.saveProject) saveProject();
    drawProfile(request.showProfile);
    const auto outputAsks = outputJobs_.draw(control_.view(), outputSource());
    if (outputAsks) control_.glideTo(*outputAsks);
    tell();
    drawHelp(helpOpen_);
    drawError(stats_.error);
    return changed || request.layersChanged || request.pictureChanged || request.goTo || outputAsks;
  }

  /// The window of a profile, which opens by itself for one that was just made.
  void drawProfile(std::optional<std::size_t> asked) {
    std::vector<Measurement>& kept = tools_.measure.kept();
    if (kept.size() > keptBefore_ && kept.back().kind == MeasureKind::profile) asked = kept.size() - 1;
    keptBefore_ = kept.size();
    if (asked && *asked < kept.size()) profile_.show(kept[*asked]);
    std::vector<std::shared_ptr<const Store>> shown;
    for (std::size_t i = 0; i < layers_.stores().size(); ++i)
      if (tools_.shown[i]) shown.push_back(layers_.stores()[i]);
    const ProfilePanel::Outcome outcome = profile_.draw(kept, shown, settings_.draw);
    if (outcome.pointed) overlayRing(control_.view(), *outcome.pointed, kPointedColour, 8.0f);
    if (!outcome.csv.empty()) save(fileNameOf(outcome.name) + ".csv", outcome.csv);
    if (!outcome.failure.empty()) stats_.error = outcome.failure;
  }

  void save(const std::string& file, const std::string& text) {
    try {
      writeText(file, text);
      stats_.notice = "saved " + file;
    } catch (const Error& error) {
      stats_.error = error.what();
    }
  }

  void saveProject() {
    const std::string file = options_.project.empty() ? tools_.layers.front() + ".project.json" : options_.project;
    std::vector<bool> shown = lostShown_;  // what is not there today is kept for another day
    for (std::size_t i = 0; i < opened_.asked.size(); ++i) shown[opened_.asked[i]] = tools_.shown[i];
    save(file, projectJson(file, {.stores = options_.stores,
                                  .shown = shown,
                                  .view = control_.view(),
                                  .draw = settings_.draw,
                                  .clipBoxes = tools_.clip.boxes(),
                                  .pointBudget = settings_.selection.pointBudget,
                                  .pointsPerPixel = settings_.selection.pointsPerPixel,
                                  .bookmarks = tools_.bookmarks,
                                  .measurements = tools_.measure.kept(),
                                  .path = outputJobs_.path(control_.view())}));
    if (!outputJobs_.state().path.keys().empty()) outputJobs_.savePath(control_.view(), outputSource());
  }

  const ViewerOptions options_;
  const OpenedStores opened_;
  Layers layers_;
  const Scene scene_;
  Window window_;
  PictureTexture texture_;
  ProfilePanel profile_;
  InspectorPanel inspector_;
  StateFile stateFile_;
  std::unique_ptr<Rasterizer> rasterizer_;
  ProgressiveRasterizer* progressive_;  ///< rasterizer_, or null where that draws everything in each frame
  CameraControl control_;
  CameraMotion motion_;
  ViewerSettings settings_;
  ViewerStats stats_;
  ColourLimits limits_;
  Backend backend_ = Backend::automatic;  ///< of rasterizer_, as asked for
  std::uint64_t damageSaid_ = 0;          ///< nodes given up that the user was told of
  std::vector<bool> lostShown_;           ///< by path asked for: what the project said
  ToolsState tools_;
  ToolInput toolInput_;
  OutputJobs outputJobs_;
  std::vector<glm::dvec4> planes_;  ///< of the command line
  std::size_t keptBefore_ = 0;      ///< measurements in the last frame
  bool helpOpen_ = false;
  std::uint64_t framesDrawn_ = 0;
  const RenderList* list_ = nullptr;  ///< that picture_ was drawn from; valid until the next drawFrame()
  Picture picture_;
};

}  // namespace

void runViewer(const ViewerOptions& asked) {
  ViewerOptions options = asked;
  std::optional<Project> project;
  if (options.stores.size() == 1 && options.stores.front().ends_with(".json") &&
      std::filesystem::is_regular_file(options.stores.front())) {
    options.project = options.stores.front();
    project = parseProject(options.project, readText(options.project));
    options.stores = project->stores;
  }
  if (!convertScans(options)) return;
  ViewerApp app(options);
  if (project) app.restore(*project);
  if (!options.screenshot.empty()) app.screenshot(options.screenshot);
  if (!options.picture.empty()) app.picture(options.picture, options.pictureSize);
  if (options.screenshot.empty() && options.picture.empty()) app.run();
}

}  // namespace strata
