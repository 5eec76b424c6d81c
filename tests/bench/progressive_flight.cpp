// Progressive drawing along a flight over a streamed store, beside the plain way of the same nodes (compute32): a row
// of docs/benchmarks/progressive.md for each. Each frame goes on by 1/fps of the path, however long it took.
//
// progressive_flight STORE PATH.json [--frames N] [--size WIDTHxHEIGHT] [--pool MILLION] [--points N,N,...]
//                    [--pictures FOLDER]
#include <algorithm>
#include <cstdio>
#include <sstream>
#include <string>

#include "core/error.h"
#include "core/image.h"
#include "core/percentile.h"
#include "core/picture.h"
#include "lod/streamer.h"
#include "render/create_rasterizer.h"
#include "render/progressive/progressive_rasterizer.h"
#include "render/stopwatch.h"
#include "viewer/bench/measures.h"
#include "viewer/camera/camera_path.h"
#include "viewer/session/draw_defaults.h"
#include "viewer/session/picture_size.h"

namespace strata::bench {
namespace {

constexpr double kAheadSeconds = 0.5;
constexpr int kCompareEvery =
    5;  ///< frames; every one of these is drawn the plain way too, and every fifth of them kept
constexpr float kNearer = 1e-3f;  ///< of the depth: what fewer bits of a position may do

struct Flight {
  std::string store, path, pictures;
  int frames = 90;
  PictureSize size{1280, 720};
  double poolMillions = 0.0;  ///< 0: the point budget, or all points, and a quarter
  std::vector<double> points{1.0, 0.5, 0.25};
};

/// Of the pixels that the plain way covers: those that show another point, nothing at all; and of all pixels those that
/// show what the plain way does not or what is nearer.
struct Late {
  double late = 0.0, open = 0.0, wrong = 0.0;
};

Late compare(const Picture& frame, const Picture& plain) {
  std::size_t covered = 0, late = 0, open = 0, wrong = 0;
  for (std::size_t i = 0; i < plain.pointId.size(); ++i) {
    const bool shown = frame.pointId[i] != Picture::kNoPoint, wanted = plain.pointId[i] != Picture::kNoPoint;
    covered += wanted;
    late += wanted && frame.pointId[i] != plain.pointId[i];
    open += wanted && !shown;
    wrong += shown && (!wanted || frame.depth[i] < plain.depth[i] * (1.0f - kNearer));
  }
  const auto share = [covered](std::size_t n) {
    return covered > 0 ? static_cast<double>(n) / static_cast<double>(covered) : 0.0;
  };
  return {share(late), share(open), static_cast<double>(wrong) / static_cast<double>(plain.pointId.size())};
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

void savePicture(const Flight& flight, const std::string& name, int index, const Picture& frame) {
  if (flight.pictures.empty()) return;
  char file[96];
  std::snprintf(file, sizeof file, "/%s_%03d.png", name.c_str(), index);
  writePng(flight.pictures + file, imageOf(frame));
}

/// `progressive`: null for the plain way alone.
void fly(const Flight& flight, const std::shared_ptr<const Store>& store, ProgressiveRasterizer* progressive,
         const std::string& name) {
  RasterizerOptions room;
  const auto plain = createRasterizer(Backend::compute32, room, createHeadlessContext());
  Rasterizer& timed = progressive != nullptr ? *progressive : *plain;
  const CameraPath path = readCameraPath(flight.path);
  const PathClock clock(path);
  const DrawOptions draw = drawOptionsFor(store->info(), store->info().bounds, std::nullopt);
  const auto view = [&](double t) {
    return viewAt(path, clock.keyTime(path.keys.front().t + t), flight.size.width, flight.size.height);
  };
  StreamerOptions streaming;
  streaming.selection.shown = shownBy(draw);
  Streamer streamer(store, streaming);
  streamer.setView(view(0.0));
  streamer.waitUntilComplete(std::chrono::minutes(2));
  Picture frame, wanted;
  while (!isFinished(timed.draw(streamer.beginFrame(), view(0.0), draw, frame))) {
  }
  std::vector<double> ms, late, open, turn, points;
  double wrong = 0.0;
  std::uint64_t mostWritten = 0;
  for (int index = 0; index < std::min(flight.frames, path.frames()); ++index) {
    const double t = index / path.fps;
    streamer.setView(view(t), view(std::min(t + kAheadSeconds, path.duration())));
    Stopwatch watch;
    const RenderList& list = streamer.beginFrame();
    timed.draw(list, view(t), draw, frame);
    ms.push_back(watch.lapMs());
    points.push_back(static_cast<double>(list.pointCount));
    if (progressive == nullptr) continue;
    turn.push_back(static_cast<double>(progressive->progress().turnPlaces));
    mostWritten = std::max(mostWritten, progressive->progress().written);
    if (index % kCompareEvery != 0) continue;
    while (!isFinished(plain->draw(list, view(t), draw, wanted))) {
    }
    const Late share = compare(frame, wanted);
    late.push_back(share.late);
    open.push_back(share.open);
    wrong = std::max(wrong, share.wrong);
    if (index % (kCompareEvery * kCompareEvery) != 0) continue;
    savePicture(flight, name, index, frame);
    savePicture(flight, "plain", index, wanted);
  }
  std::printf("| %s | %.1f ms | %.1f ms | %.1f ms | %.2f M |", name.c_str(), percentile(ms, 50), percentile(ms, 95),
              percentile(ms, 99), mean(points) * 1e-6);
  if (progressive == nullptr) {
    std::printf(" - | - | 0 | 0 | 0 |\n");
  } else {
    std::printf(" %.2f M | %.2f M | %.0f %% | %.0f %% (%.0f %%) | %.2g %% |\n", mean(turn) * 1e-6,
                static_cast<double>(mostWritten) * 1e-6, 100.0 * mean(late), 100.0 * mean(open),
                100.0 * percentile(open, 100), 100.0 * wrong);
  }
  std::fflush(stdout);
}

int run(const Flight& flight) {
  const auto store = std::make_shared<const Store>(flight.store);
  std::printf(
      "| way | p50 | p95 | p99 | points of the view | turn | most written in a frame | late pixels | open pixels "
      "(most) | wrong pixels, most |\n|---|---|---|---|---|---|---|---|---|---|\n");
  fly(flight, store, nullptr, "compute32");
  for (const double millions : flight.points) {
    const std::uint64_t pool = static_cast<std::uint64_t>(
        flight.poolMillions > 0.0
            ? 1e6 * flight.poolMillions
            : 1.25 * static_cast<double>(std::min(StreamerOptions{}.selection.pointBudget, store->info().points)));
    const auto n = static_cast<std::uint64_t>(1e6 * millions);
    const auto progressive = createProgressiveRasterizer(createHeadlessContext(), {n, std::max(n / 2, n % 2), pool});
    char name[48];
    std::snprintf(name, sizeof name, "progressive %g M", millions);
    fly(flight, store, progressive.get(), name);
  }
  return 0;
}

Flight parse(int argc, char** argv) {
  if (argc < 3 || argc % 2 == 0) throw UsageError("expected STORE PATH.json, then options and their values");
  Flight flight;
  flight.store = argv[1];
  flight.path = argv[2];
  for (int i = 3; i + 1 < argc; i += 2) {
    const std::string option = argv[i], value = argv[i + 1];
    if (option == "--frames") {
      flight.frames = std::stoi(value);
    } else if (option == "--size") {
      flight.size = parseSize(value);
    } else if (option == "--pool") {
      flight.poolMillions = std::stod(value);
    } else if (option == "--pictures") {
      flight.pictures = value;
    } else if (option == "--points") {
      flight.points.clear();
      std::istringstream list(value);
      for (std::string one; std::getline(list, one, ',');) flight.points.push_back(std::stod(one));
    } else {
      throw UsageError("unknown option " + option);
    }
  }
  return flight;
}

}  // namespace
}  // namespace strata::bench

int main(int argc, char** argv) {
  try {
    return strata::bench::run(strata::bench::parse(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
