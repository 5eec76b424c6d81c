#pragma once
#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "lod/streamer.h"
#include "render/rasterizer.h"

namespace strata {

/// How the last frames went: figures for small plots. For the render thread.
class FrameHistory {
 public:
  using Clock = std::chrono::steady_clock;

  enum class Series { frameMs, pointsDrawn, nodesDrawn, missingNodes, queue, cacheBytes, readBytesPerSecond, hitRate };
  static constexpr int kSeries = 8;
  static constexpr std::size_t kLength = 120;  ///< frames that are kept
  /// Rates are over at least this long: what comes in one frame says little.
  static constexpr std::chrono::milliseconds kWindow{500};

  struct FrameFigures {
    double frameMs = 0.0;
    std::uint64_t pointsDrawn = 0;
    std::uint64_t nodesDrawn = 0;
    std::uint64_t missingNodes = 0;
  };
  /// Once a frame.
  void add(Clock::time_point now, const FrameFigures& frame, const StreamerStats& streamer);

  /// Oldest first, at most kLength.
  std::span<const float> series(Series which) const { return series_[static_cast<std::size_t>(which)]; }
  double latest(Series which) const;
  /// Of the frames that are kept; 0 where there are none.
  double largest(Series which) const;

 private:
  std::array<std::vector<float>, kSeries> series_;
  bool begun_ = false;
  Clock::time_point windowBegin_;
  std::uint64_t bytesAtBegin_ = 0, hitsAtBegin_ = 0, missesAtBegin_ = 0;
  double bytesPerSecond_ = 0.0, hitRate_ = 1.0;
};

}  // namespace strata
