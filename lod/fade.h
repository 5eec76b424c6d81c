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

/// How fast nodes may come in. The selection is continuous in the view, but a camera that passes a wall closely, or
/// dives, changes the view so fast that a node would jump from nothing to all within a frame or two. A node that could
/// have been drawn last time, being in memory, in view and not hidden, grows by an even share of its points a second;
/// one that could not comes at once, and all that comes below it. One thread; a list's nodes by ascending index.
class Fade {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// The arguments have to outlive it.
  Fade(const Hierarchy& hierarchy, const HierarchyIndex& index) : hierarchy_(hierarchy), index_(index) {}

  /// A new list begins. From nothing to all takes `seconds` at least; 0: nothing is held back.
  void begin(double seconds, Time now);
  /// What of the `wanted` points of a node is drawn now, at least 1 of them. Its parent, where it has one, has been
  /// asked for before; `wasMissing`: the last list wanted it and could not have it.
  std::uint32_t allow(std::uint32_t node, std::uint32_t wanted, bool wasMissing);
  /// The list is done. `hidden`: the topmost nodes that were left out as hidden.
  void end(const View& view, std::span<const std::uint32_t> hidden);

  /// Nodes that the list has fewer points of than wanted.
  std::uint32_t held() const { return held_; }

 private:
  struct Drawn {
    std::uint32_t node = 0, points = 0;
    bool atOnce = false;  ///< it is new and was not held back
  };
  static const Drawn* find(const std::vector<Drawn>& list, std::uint32_t node);
  bool couldBeDrawnLast(std::uint32_t node) const;

  const Hierarchy& hierarchy_;
  const HierarchyIndex& index_;

  double share_ = 1.0;  ///< of its points, by which a node may grow
  std::uint32_t held_ = 0;
  std::vector<Drawn> now_;

  // Of the last list.
  std::vector<Drawn> last_;
  std::optional<ViewVolume> lastVolume_;
  std::vector<std::uint32_t> lastHidden_;  ///< ascending
  Time lastTime_;
};

}  // namespace strata
