#include "viewer/window/frame_history.h"

#include <algorithm>

namespace strata {

void FrameHistory::add(Clock::time_point now, const FrameFigures& frame, const StreamerStats& streamer) {
  const auto beginWindow = [&] {
    windowBegin_ = now;
    bytesAtBegin_ = streamer.bytesRead;
    hitsAtBegin_ = streamer.cacheHits;
    missesAtBegin_ = streamer.cacheMisses;
  };
  if (!begun_) beginWindow();
  begun_ = true;
  if (now - windowBegin_ >= kWindow) {
    const double seconds = std::chrono::duration<double>(now - windowBegin_).count();
    bytesPerSecond_ = static_cast<double>(streamer.bytesRead - bytesAtBegin_) / seconds;
    const double hits = static_cast<double>(streamer.cacheHits - hitsAtBegin_);
    const double misses = static_cast<double>(streamer.cacheMisses - missesAtBegin_);
    if (hits + misses > 0.0) hitRate_ = hits / (hits + misses);
    beginWindow();
  }
  const std::array<double, kSeries> figures{frame.frameMs,
                                            static_cast<double>(frame.pointsDrawn),
                                            static_cast<double>(frame.nodesDrawn),
                                            static_cast<double>(frame.missingNodes),
                                            static_cast<double>(streamer.queueLength),
                                            static_cast<double>(streamer.residentBytes),
                                            bytesPerSecond_,
                                            hitRate_};
  for (std::size_t i = 0; i < figures.size(); ++i) {
    if (series_[i].size() == kLength) series_[i].erase(series_[i].begin());
    series_[i].push_back(static_cast<float>(figures[i]));
  }
}

double FrameHistory::latest(Series which) const {
  const std::span<const float> all = series(which);
  return all.empty() ? 0.0 : static_cast<double>(all.back());
}

double FrameHistory::largest(Series which) const {
  const std::span<const float> all = series(which);
  return all.empty() ? 0.0 : static_cast<double>(*std::max_element(all.begin(), all.end()));
}

}  // namespace strata
