#pragma once
#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "lod/streamer.h"
#include "render/rasterizer.h"

namespace strata {

/// The figures of the newest frames, for small plots. For the render thread.
class FrameHistory {
 public:
  using Clock = std::chrono::steady_clock;

  enum class Series { frameMs, pointsDrawn, nodesDrawn, missingNodes, queue, cacheBytes, readBytesPerSecond, hitRate };
  static constexpr int kSeries = 8;
  static constexpr std::size_t kLength = 120;  ///< frames that are kept
  /// Rates are means over at least this time: a single frame says little.
  static constexpr std::chrono::milliseconds kWindow{500};

  struct FrameFigures {
    double frameMs = 0.0;
    std::uint64_t pointsDrawn = 0;
    std::uint64_t nodesDrawn = 0;
    std::uint64_t missingNodes = 0;
  };
  /// Takes in one frame. The rates follow from `now` and the counts of `streamer`.
  void add(Clock::time_point now, const FrameFigures& frame, const StreamerStats& streamer);

  /// The figures of at most kLength frames, oldest first.
  std::span<const float> series(Series which) const { return series_[static_cast<std::size_t>(which)]; }
  // Of the frames that are kept; 0 where there are none.
  double latest(Series which) const;
  double largest(Series which) const;

 private:
  std::array<std::vector<float>, kSeries> series_;
  bool begun_ = false;
  Clock::time_point windowBegin_;
  std::uint64_t bytesAtBegin_ = 0, hitsAtBegin_ = 0, missesAtBegin_ = 0;
  double bytesPerSecond_ = 0.0, hitRate_ = 1.0;
};

}  // namespace strata
