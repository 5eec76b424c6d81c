#pragma once
#include <span>
#include <vector>

#include "core/render_list.h"
#include "viewer/bench/measures.h"

namespace strata {

/// Watches how the picture fills after each jump of the camera: at the start and at each cut of the path. Times are
/// milliseconds of one clock.
class JumpWatch {
 public:
  /// The camera is put to a new place, `t` seconds along the path.
  void begin(double t, double nowMs);
  /// The view of the camera from now on, until the next jump or view.
  void look(const View& view);
  /// Takes the list that is drawn at `nowMs`. Returns the share of the wanted nodes that it draws as finely as wanted,
  /// 0 to 1, or 0 for a list that was selected before the jump.
  double see(const RenderList& list, double nowMs);
  std::vector<JumpRecord> take() { return std::move(jumps_); }

 private:
  std::vector<JumpRecord> jumps_;
  std::vector<View> sinceJump_;
  double beganMs_ = 0.0;
};

/// The median over several runs of one flight of the time to each share at each jump; -1 when half of the runs or more
/// never got there.
std::vector<JumpRecord> medianJumps(std::span<const std::vector<JumpRecord>> runs);

}  // namespace strata
