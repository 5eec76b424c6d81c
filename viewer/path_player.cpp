#include "viewer/path_player.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>
#include <utility>

namespace strata {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kLongestWait{120'000};  // for full detail of one view
constexpr int kMostUploadFrames = 1000;
constexpr int kReportPictures = 16;        // that the report shows
constexpr std::size_t kHeldPictures = 24;  // waiting to be encoded; 8 MB each at 1920x1080

double msSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Pictures wait here while the flight goes on and become files in a batch.
class PictureShelf {
 public:
  PictureShelf(const PlayOptions& options, int frames) : folder_(options.folder), every_(options.screenshotEvery) {
    if (every_ > 0) shownEvery_ = std::max(1, (((frames - 1) / every_ + 1) + kReportPictures - 1) / kReportPictures);
  }

  void offer(const FrameRecord& record, const Frame& frame) {
    if (every_ <= 0 || record.index % every_ != 0) return;
    char file[40], title[64];
    std::snprintf(file, sizeof file, "frame_%05d.png", record.index);
    std::snprintf(title, sizeof title, "frame %d, %.1f s", record.index, record.t);
    waiting_.push_back({title, file, true, imageOf(frame)});
    if (waiting_.size() >= kHeldPictures) flush();
  }

  void flush() {
    for (ReportPicture& picture : waiting_) {
      writePng(folder_ + "/" + picture.file, picture.image);
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
  int shownEvery_ = 1;
  std::vector<ReportPicture> waiting_, done_;
};

FrameRecord drawFrame(const View& view, const DrawOptions& draw, Streamer& streamer, Rasterizer& rasterizer,
                      Frame& frame) {
  FrameRecord record;
  const Clock::time_point start = Clock::now();
  const RenderList& list = streamer.beginFrame();
  record.listMs = msSince(start);
  const DrawStats stats = rasterizer.draw(list, view, draw, frame);
  record.frameMs = msSince(start);
  record.uploadMs = stats.uploadMs;
  record.drawMs = stats.drawMs;
  record.resolveMs = stats.resolveMs;
  record.pointsDrawn = stats.pointsDrawn;
  record.pointsListed = list.pointCount;
  record.nodes = static_cast<std::uint32_t>(list.items.size());
  record.missingNodes = list.missingNodes;
  record.bytesUploaded = stats.bytesUploaded;
  return record;
}

}  // namespace

Frame drawComplete(const View& view, const DrawOptions& draw, Streamer& streamer, Rasterizer& rasterizer) {
  Frame frame;
  streamer.setView(view);
  streamer.waitUntilComplete(kLongestWait);
  const RenderList& list = streamer.beginFrame();
  for (int i = 0; i < kMostUploadFrames; ++i)
    if (rasterizer.draw(list, view, draw, frame).nodesNotUploaded == 0) break;
  return frame;
}

PlayedPath playPath(const CameraPath& path, const PlayOptions& options, Streamer& streamer, Rasterizer& rasterizer) {
  const int frames = path.frames();
  const auto view = [&](int index) {
    View v = viewAt(path, path.keys.front().t + index / path.fps, options.size.width, options.size.height);
    v.nearPlane = options.nearPlane;
    return v;
  };
  PlayedPath played;
  const Clock::time_point opened = Clock::now();
  streamer.setView(view(0));
  played.reachedFullDetail = streamer.waitUntilComplete(kLongestWait);
  played.timeToFullDetailMs = msSince(opened);
  Frame frame = drawComplete(view(0), options.draw, streamer, rasterizer);

  PictureShelf shelf(options, frames);
  played.frames.reserve(static_cast<std::size_t>(frames));
  Clock::time_point due = Clock::now();
  for (int index = 0; index < frames; ++index) {
    const View now = view(index);
    streamer.setView(now);
    double settleMs = 0.0;
    if (options.settle) {
      const Clock::time_point start = Clock::now();
      streamer.waitUntilComplete(kLongestWait);
      settleMs = msSince(start);
    }
    FrameRecord record = drawFrame(now, options.draw, streamer, rasterizer, frame);
    const StreamerStats stats = streamer.stats();
    record.index = index;
    record.t = index / path.fps;
    record.settleMs = settleMs;
    record.lodMs = stats.lodMs;
    record.bytesRead = stats.bytesRead;
    record.hitch = index > 0 && isHitch(played.frames.back().frameMs, record.frameMs);
    played.frames.push_back(record);
    shelf.offer(record, frame);
    // Real time: the loader gets the time that a flight at this rate leaves it, no more.
    due = std::max(due + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / path.fps)),
                   Clock::now());
    if (!options.settle) std::this_thread::sleep_until(due);
  }
  played.pictures = shelf.take();
  return played;
}

}  // namespace strata
