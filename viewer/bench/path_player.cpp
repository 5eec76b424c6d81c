#include "viewer/bench/path_player.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <optional>
#include <thread>
#include <utility>

#include "core/picture.h"
#include "lod/hierarchy_index.h"
#include "viewer/bench/jump_watch.h"
#include "viewer/bench/screen_spacing.h"
#include "viewer/output/video.h"

namespace strata {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kLongestWait{120'000};  // for full detail of one view
constexpr std::chrono::milliseconds kDetailStep{2};         // how finely the detail of the first view is watched
constexpr int kMostUploadFrames = 100'000;
constexpr double kAheadSeconds = 0.5;      // for how far along the path nodes are loaded before they are seen
constexpr int kReportPictures = 16;        // that the report shows
constexpr std::size_t kHeldPictures = 24;  // waiting to be encoded; 8 MB each at 1920x1080

double msSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Pictures wait here while the flight goes on and become files in a batch.
class PictureShelf {
 public:
  PictureShelf(const PlayOptions& options, const CameraPath& path)
      : folder_(options.folder),
        every_(options.screenshotEvery),
        marked_(options.pictures ? markedFrames(path) : std::vector<int>{}) {
    const int count = (every_ > 0 ? (path.frames() - 1) / every_ + 1 : 0) + static_cast<int>(marked_.size());
    shownEvery_ = std::max(1, (count + kReportPictures - 1) / kReportPictures);
  }

  void offer(const FrameRecord& record, const Picture& frame) {
    const bool marked = std::binary_search(marked_.begin(), marked_.end(), record.index);
    if (!marked && (every_ <= 0 || record.index % every_ != 0)) return;
    char file[40], title[64];
    std::snprintf(file, sizeof file, "frame_%05d.png", record.index);
    std::snprintf(title, sizeof title, "frame %d, %.1f s", record.index, record.t);
    waiting_.push_back({title, file, true, imageOf(frame)});
    if (waiting_.size() >= kHeldPictures) flush();
  }

  void flush() {
    for (ReportPicture& picture : waiting_) {
      writePng(folder_ + "/" + picture.file, picture.image);
      picture.hash = imageHash(picture.image);
      const bool shown = static_cast<int>(done_.size()) % shownEvery_ == 0;
      if (!shown) picture.image = {};
      done_.push_back(std::move(picture));
    }
    waiting_.clear();
  }

  std::vector<ReportPicture> take() {
    flush();
    return std::move(done_);
  }

 private:
  const std::string folder_;
  const int every_;
  const std::vector<int> marked_;
  int shownEvery_ = 1;
  std::vector<ReportPicture> waiting_, done_;
};

std::uint64_t coveredPixels(const Picture& frame) {
  return frame.pointId.size() -
         static_cast<std::uint64_t>(std::count(frame.pointId.begin(), frame.pointId.end(), Picture::kNoPoint));
}

/// The stages of a draw, as its stats say how long they took, one after the other from `begin` to at most `end`.
void traceStages(TraceLane& lane, const DrawStats& stats, Clock::time_point begin, Clock::time_point end) {
  const std::pair<const char*, double> stages[] = {
      {"upload", stats.uploadMs}, {"rasterize", stats.drawMs}, {"resolve", stats.resolveMs}};
  for (const auto& [name, ms] : stages) {
    const auto length = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::milli>(ms));
    const Clock::time_point done = std::min(begin + length, end);
    if (ms > 0.0) lane.add({name, begin, done, nullptr, 0});
    begin = done;
  }
}

FrameRecord drawFrame(const View& view, const PlayOptions& options, int index, Streamer& streamer,
                      Rasterizer& rasterizer, Picture& frame, const RenderList*& drawn) {
  FrameRecord record;
  const Clock::time_point start = Clock::now();
  const RenderList& list = streamer.beginFrame();
  drawn = &list;
  const Clock::time_point listed = Clock::now();
  const DrawStats stats = rasterizer.draw(list, view, options.draw, frame);
  const Clock::time_point end = Clock::now();
  if (options.lane != nullptr) {
    options.lane->add({"frame", start, end, "frame", static_cast<std::uint64_t>(index)});
    options.lane->add({"take the render list", start, listed, "nodes", list.items.size()});
    options.lane->add({"draw", listed, end, "points", stats.pointsDrawn});
    traceStages(*options.lane, stats, listed, end);
  }
  record.listMs = std::chrono::duration<double, std::milli>(listed - start).count();
  record.frameMs = std::chrono::duration<double, std::milli>(end - start).count();
  record.uploadMs = stats.uploadMs;
  record.drawMs = stats.drawMs;
  record.resolveMs = stats.resolveMs;
  record.pointsDrawn = stats.pointsDrawn;
  record.pointsListed = list.pointCount;
  record.nodes = static_cast<std::uint32_t>(list.items.size());
  record.missingNodes = list.missingNodes;
  record.bytesUploaded = stats.bytesUploaded;
  record.gpuBytes = stats.gpuBytes;
  record.gpuMs = stats.gpuMs;
  return record;
}

}  // namespace

Picture drawComplete(const View& view, const DrawOptions& draw, Streamer& streamer, Rasterizer& rasterizer) {
  Picture frame;
  streamer.setView(view);
  streamer.waitUntilComplete(kLongestWait);
  const RenderList& list = streamer.beginFrame();
  for (int i = 0; i < kMostUploadFrames; ++i)
    if (isFinished(rasterizer.draw(list, view, draw, frame))) break;
  return frame;
}

PlayedPath playPath(const CameraPath& path, const PlayOptions& options, Streamer& streamer, Rasterizer& rasterizer) {
  const int frames = path.frames();
  const PathClock clock(path);
  const HierarchyIndex hierarchy =
      options.store != nullptr ? indexHierarchy(options.store->hierarchy()) : HierarchyIndex{};
  const auto view = [&](int index) {
    View v =
        viewAt(path, clock.keyTime(path.keys.front().t + index / path.fps), options.size.width, options.size.height);
    v.nearPlane = options.nearPlane;
    return v;
  };
  PlayedPath played;
  JumpWatch jumps;
  const View firstView = view(0);
  const Clock::time_point opened = Clock::now();
  TraceScope span(options.lane, "first view");
  jumps.begin(0.0, 0.0);
  jumps.look(firstView);
  streamer.setView(firstView);
  while (!played.reachedFullDetail && Clock::now() - opened < kLongestWait) {
    played.reachedFullDetail = streamer.waitUntilComplete(kDetailStep);
    jumps.see(streamer.beginFrame(), msSince(opened));
  }
  played.timeToFullDetailMs = msSince(opened);
  Picture frame = drawComplete(firstView, options.draw, streamer, rasterizer);

  PictureShelf shelf(options, path);
  std::optional<VideoWriter> video;
  if (!options.video.empty()) video.emplace(options.video, options.size.width, options.size.height, path.fps);
  const std::vector<int> cuts = cutFrames(path);
  const int aheadFrames = static_cast<int>(std::lround(kAheadSeconds * path.fps));
  played.frames.reserve(static_cast<std::size_t>(frames));
  Clock::time_point due = Clock::now();
  for (int index = 0; index < frames; ++index) {
    const View now = view(index);
    span.next("place the camera");
    if (std::binary_search(cuts.begin(), cuts.end(), index)) jumps.begin(index / path.fps, msSince(opened));
    jumps.look(now);
    streamer.setView(now, view(std::min(index + aheadFrames, frames - 1)));
    double settleMs = 0.0;
    if (options.settle) {
      span.next("wait for detail");
      const Clock::time_point start = Clock::now();
      streamer.waitUntilComplete(kLongestWait);
      settleMs = msSince(start);
    }
    const RenderList* list = nullptr;
    span.next("draw and measure");
    FrameRecord record = drawFrame(now, options, index, streamer, rasterizer, frame, list);
    record.detail = jumps.see(*list, msSince(opened));
    const StreamerStats stats = streamer.stats();
    record.index = index;
    record.t = index / path.fps;
    record.settleMs = settleMs;
    record.lodMs = stats.lodMs;
    record.bytesRead = stats.bytesRead;
    record.queueLength = stats.queueLength;
    record.residentBytes = stats.residentBytes;
    record.pixelsCovered = coveredPixels(frame);
    if (options.store != nullptr)
      record.widestSpacingPx = widestSpacing(options.store->hierarchy(), hierarchy, *list, now, frame);
    record.hitch = index > 0 && isHitch(played.frames.back().frameMs, record.frameMs);
    played.frames.push_back(record);
    if (options.pictures) span.next("keep pictures");
    shelf.offer(record, frame);
    if (video) video->add(imageOf(frame));
    // Real time: the loader gets the time that a flight at this rate leaves it, no more.
    due = std::max(due + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / path.fps)),
                   Clock::now());
    if (!options.settle) {
      span.next("wait for the next frame");
      std::this_thread::sleep_until(due);
    }
  }
  span.next("write pictures");
  if (video) video->finish();
  played.jumps = jumps.take();
  played.pictures = shelf.take();
  return played;
}

}  // namespace strata
