// Kanzok, Linsen, Rosenthal 2015: Table 3, three views of an outdoor and an indoor scan, three node sizes, with and
// without the occlusion test.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/image.h"
#include "core/log.h"
#include "core/percentile.h"
#include "core/picture.h"
#include "io/file/text_file.h"
#include "lod/streamer.h"
#include "tests/bench/suites/measure.h"
#include "tests/bench/suites/suites.h"
#include "viewer/bench/measures.h"
#include "viewer/bench/page_cache.h"
#include "viewer/camera/stills.h"
#include "viewer/session/converter_program.h"
#include "viewer/session/draw_defaults.h"

namespace strata::suite {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::minutes kLongest{5};
constexpr int kNodeSizes[] = {1 << 15, 1 << 16, 1 << 17};
constexpr double kOutdoorPoints = 1800.0, kIndoorPoints = 360.0;  // millions, of the paper's scans

double msSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// What one view took, the camera having jumped there from the view before.
struct Seen {
  double points = 0.0, fps = 0.0, wholeMs = 0.0;  ///< wholeMs: from the jump until the picture was whole
  std::size_t nodes = 0;
};

/// Of one line of the table.
struct Line {
  Seen views[3];
  double readMb = 0.0;
};

/// One flight by jumps over the three views, from empty caches.
Line flyViews(const std::string& path, const std::vector<View>& views, bool occlusion, const Setup& setup,
              const std::string& pictures) {
  const auto store = std::make_shared<const Store>(path);
  dropFromPageCache(store->points().name());
  StreamerOptions options;
  options.selection.occlusion.enabled = occlusion;
  options.selection.pointBudget = SelectionOptions::kMaxPointBudget;
  options.cacheBytes = std::uint64_t{4} << 30;
  RasterizerOptions room;
  room.gpuBytes = std::uint64_t{4} << 30;
  const auto rasterizer =
      createRasterizer(setup.backend(), room, setup.ours == "cpu" ? nullptr : createHeadlessContext());
  const DrawOptions draw = drawOptionsFor(store->info(), store->info().bounds, std::nullopt);
  options.selection.shown = shownBy(draw);
  Streamer streamer(store, options);
  Line line;
  Picture frame;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto start = Clock::now();
    streamer.setView(views[i]);
    if (!streamer.waitUntilComplete(kLongest))
      throw Error(path, "view " + std::to_string(i + 1) + " was not loaded in time");
    while (rasterizer->draw(streamer.beginFrame(), views[i], draw, frame).nodesNotUploaded > 0 &&
           msSince(start) < 3e5) {
    }
    Seen& seen = line.views[i];
    seen.wholeMs = msSince(start);
    std::vector<double> times;
    for (int f = 0; f < setup.frames; ++f) {
      const auto began = Clock::now();
      const RenderList& list = streamer.beginFrame();
      rasterizer->draw(list, views[i], draw, frame);
      times.push_back(msSince(began));
      seen.nodes = list.items.size();
      seen.points = static_cast<double>(list.pointCount);
    }
    seen.fps = 1e3 / percentile(times, 50.0);
    if (!pictures.empty()) writePng(pictures + "_view" + std::to_string(i + 1) + ".png", imageOf(frame));
  }
  line.readMb = 1e-6 * static_cast<double>(streamer.stats().bytesRead);
  return line;
}

std::vector<View> outdoorViews(const Store& store, const Setup& setup) {
  std::vector<View> views;
  for (const Still& still : chooseStills(sampleStore(store), store, setup.width, setup.height))
    views.push_back(still.view);
  return views;
}

/// Of the office floor (io/synthetic/room.cpp): from above, from the entrance along the corridor, at the desk of a room
/// that is an office always.
std::vector<View> indoorViews(const Store& store, const Setup& setup) {
  constexpr double kOuterWall = 0.3, kRoom = 4.8, kMiddle = 7.35, kNorth = 14.7;
  const Box& box = store.info().bounds;
  const glm::dvec3 corner = box.min + glm::dvec3(kOuterWall, kOuterWall, 0.0);
  const double length = box.size().x - 2.0 * kOuterWall;
  View entrance, desk;
  entrance.eye = corner + glm::dvec3(0.5, kMiddle, 1.7);
  entrance.target = corner + glm::dvec3(length, kMiddle, 1.3);
  desk.eye = corner + glm::dvec3(kRoom + 1.6, kNorth - 2.5, 1.4);
  desk.target = corner + glm::dvec3(kRoom + 1.25, kNorth - 1.5, 0.85);
  return {viewOfBox(box, {0.3, 0.4, -1.0}, setup.width, setup.height, 1.0), setup.sized(entrance), setup.sized(desk)};
}

/// Of the paper, Table 3: nodes, million points, frames a second; seconds of the two jumps.
struct PaperLine {
  double nodes[3], points[3], fps[3], load[2];
};
constexpr PaperLine kPaper[2][3][2] = {{{{{294, 923, 452}, {6.7, 17.7, 11.8}, {19, 14, 17}, {11.8, 4.9}},
                                         {{298, 1304, 481}, {6.7, 22.5, 12.7}, {19, 11, 16}, {19.0, 4.8}}},
                                        {{{183, 469, 235}, {7.8, 19.6, 14.0}, {15, 13, 24}, {7.6, 3.4}},
                                         {{197, 661, 261}, {8.0, 25.3, 15.5}, {16, 10, 15}, {11.9, 3.8}}},
                                        {{{89, 257, 161}, {9.1, 21.8, 18.6}, {10, 12, 14}, {7.4, 3.9}},
                                         {{89, 388, 175}, {9.1, 30.0, 20.2}, {12, 10, 13}, {11.6, 4.7}}}},
                                       {{{{26, 846, 107}, {0.736, 18.7, 3.5}, {56, 16, 49}, {8.1, 0.9}},
                                         {{26, 1910, 109}, {0.764, 36.7, 3.5}, {56, 8, 57}, {33.0, 0.6}}},
                                        {{{19, 452, 79}, {1.0, 23.3, 5.1}, {54, 16, 51}, {7.0, 1.1}},
                                         {{20, 998, 81}, {1.0, 41.8, 5.3}, {55, 8, 55}, {19.1, 1.1}}},
                                        {{{22, 798, 53}, {0.631, 20.5, 1.7}, {57, 18, 58}, {10.9, 0.8}},
                                         {{23, 1106, 57}, {0.736, 26.4, 1.8}, {57, 15, 57}, {17.5, 0.8}}}}};

void printLines(int nodePoints, bool occlusion, const Line& line, const PaperLine& paper) {
  const std::string name = std::to_string(nodePoints) + (occlusion ? ", with" : ", without");
  std::vector<std::string> cells{name}, papers{"*" + name + "*"};
  for (std::size_t i = 0; i < 3; ++i) {
    const Seen& seen = line.views[i];
    cells.insert(cells.end(), {std::to_string(seen.nodes), count(seen.points), number(seen.fps, 0)});
    papers.insert(papers.end(), {number(paper.nodes[i], 0), count(paper.points[i] * 1e6), number(paper.fps[i], 0)});
    if (i == 2) continue;
    cells.push_back(number(1e-3 * line.views[i + 1].wholeMs, 2) + " s");
    papers.push_back(number(paper.load[i], 1) + " s");
  }
  cells.insert(cells.end(), {number(1e-3 * line.views[0].wholeMs, 2) + " s", number(line.readMb, 1)});
  papers.insert(papers.end(), {"-", "-"});
  printRow(cells);
  printRow(papers);
}

void scene(bool indoor, const Setup& setup, const std::string& folder, bool keep) {
  const double millions = indoor ? kIndoorPoints : kOutdoorPoints;
  const std::string name = indoor ? "indoor" : "outdoor";
  std::printf("\n%s, %s points (the paper's %s: %s).\n", indoor ? "Indoors: an office floor" : "Outdoors: a city",
              count(static_cast<double>(setup.points(millions))).c_str(), indoor ? "office" : "bridge",
              count(millions * 1e6).c_str());
  printHeader({"points a node, occlusion test", "overview nodes", "points", "fps", "→", "close nodes", "points", "fps",
               "→", "detail nodes", "points", "fps", "first view", "MB read"});
  std::vector<View> views;
  for (std::size_t size = 0; size < 3; ++size) {
    const std::string store = folder + "/" + name + "_" + std::to_string(kNodeSizes[size]) + ".strata";
    if (!fs::exists(store + "/store.json"))
      convertToStore(std::string("synthetic:") + (indoor ? "room" : "city") +
                         "?points=" + std::to_string(setup.points(millions)) + "&seed=1",
                     store, {"--node-points", std::to_string(kNodeSizes[size]), "--resume", "--json"});
    if (views.empty()) {
      const Store opened(store);
      views = indoor ? indoorViews(opened, setup) : outdoorViews(opened, setup);
    }
    for (const bool occlusion : {true, false})
      printLines(kNodeSizes[size], occlusion,
                 flyViews(store, views, occlusion, setup, keep && occlusion && size == 1 ? folder + "/" + name : ""),
                 kPaper[indoor ? 1 : 0][size][occlusion ? 0 : 1]);
    if (!keep) fs::remove_all(store);
  }
}

/// A folder for the stores, removed at the end unless the user named it.
class Folder {
 public:
  explicit Folder(const std::string& named) : path_(named), made_(named.empty()) {
    if (!made_) {
      makeFolder(path_);
      return;
    }
    std::string pattern = (fs::temp_directory_path() / "strata-suite-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw posixError(pattern, "making a folder", errno);
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    if (made_) fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  const bool made_;
};

}  // namespace

void runKanzok(const SuiteOptions& options) {
  const Setup setup = setUp(options, 1920, 1080);
  printHead("Kanzok, Linsen, Rosenthal 2015, Table 3", setup);
  std::printf(
      "The paper's rows in italics: Core i7, GeForce GTX 680 of 2 GB, a hard disk. Points of a node, with and without "
      "the\n"
      "occlusion test; → is the time from the jump to the next view until it was whole, from a page cache without the\n"
      "points. 1.8 points a pixel, one loader.\n");
  const Folder folder(options.folder);
  for (const bool indoor : {false, true}) scene(indoor, setup, folder.path(), !options.folder.empty());
}

}  // namespace strata::suite
