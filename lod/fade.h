#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/view.h"
#include "io/store/store.h"
#include "lod/contour.h"
#include "lod/hierarchy_index.h"

namespace strata {

/// Limits how fast nodes come in. The selection is continuous in the view, but a camera that dives, or passes close to
/// a wall, changes the view so fast that a node would jump from nothing to all of its points within a frame or two. A
/// node that could have been drawn last time (it was in memory, in view and not hidden) grows by an even share of its
/// points per second. Any other node comes at once, and so does everything that comes below it. For one thread, which
/// asks for the nodes of a list in ascending order.
class Fade {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// The arguments have to outlive the Fade.
  Fade(const Hierarchy& hierarchy, const HierarchyIndex& index) : hierarchy_(hierarchy), index_(index) {}

  /// Begins a list. A node takes at least `seconds` from no points to all; 0 holds nothing back.
  void begin(double seconds, Time now);
  /// How many of the `wanted` points of a node are drawn now, at least 1. Its parent has been asked for before, unless
  /// it is the root. `wasMissing` says that the last list wanted the node and could not have it.
  std::uint32_t allow(std::uint32_t node, std::uint32_t wanted, bool wasMissing);
  /// Ends the list. `hidden` are the topmost nodes that were left out as hidden.
  void end(const View& view, std::span<const std::uint32_t> hidden);

  /// How many nodes of the list have fewer points than wanted.
  std::uint32_t held() const { return held_; }

 private:
  struct Drawn {
    std::uint32_t node = 0, points = 0;
    bool atOnce = false;  ///< it is new and came at once
  };
  static const Drawn* find(const std::vector<Drawn>& list, std::uint32_t node);
  bool couldBeDrawnLast(std::uint32_t node) const;

  // Constant after construction.
  const Hierarchy& hierarchy_;
  const HierarchyIndex& index_;

  // The list that has begun.
  double share_ = 1.0;  ///< share of its points by which a node may grow in this list
  std::uint32_t held_ = 0;
  std::vector<Drawn> now_;  ///< by ascending node

  // The list before.
  std::vector<Drawn> last_;
  std::optional<ViewVolume> lastVolume_;
  std::vector<std::uint32_t> lastHidden_;  ///< ascending
  Time lastTime_;
};

}  // namespace strata
