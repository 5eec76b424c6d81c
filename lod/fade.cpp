#include "lod/fade.h"

#include <algorithm>

namespace strata {

void Fade::begin(double seconds, Time now) {
  const double passed = std::chrono::duration<double>(now - lastTime_).count();
  share_ = seconds > 0.0 && lastVolume_ ? std::max(passed, 0.0) / seconds : 1.0;
  lastTime_ = now;
  held_ = 0;
  std::swap(now_, last_);
  now_.clear();
}

const Fade::Drawn* Fade::find(const std::vector<Drawn>& list, std::uint32_t node) {
  const auto found = std::lower_bound(list.begin(), list.end(), node,
                                      [](const Drawn& drawn, std::uint32_t index) { return drawn.node < index; });
  return found != list.end() && found->node == node ? &*found : nullptr;
}

bool Fade::couldBeDrawnLast(std::uint32_t node) const {
  const Drawn* const parent = find(now_, index_.parent[node]);
  if (parent != nullptr && parent->atOnce) return false;
  if (std::binary_search(lastHidden_.begin(), lastHidden_.end(), node)) return false;
  const double reach = static_cast<double>(index_.reach[node]);
  return lastVolume_ && contourInView(contourOf(hierarchy_.nodes[node]), reach, *lastVolume_);
}

std::uint32_t Fade::allow(std::uint32_t node, std::uint32_t wanted, bool wasMissing) {
  const Drawn* const before = find(last_, node);
  Drawn drawn{node, wanted, false};
  if (share_ < 1.0) {
    // A node below one that comes at once comes at once too: couldBeDrawnLast() looks at its parent.
    drawn.atOnce = before == nullptr && (wasMissing || !couldBeDrawnLast(node));
    if (!drawn.atOnce) {
      const double growth = share_ * hierarchy_.nodes[node].pointCount;
      const auto most = (before != nullptr ? before->points : 0) + std::max(static_cast<std::uint32_t>(growth), 1u);
      drawn.points = std::min(wanted, most);
      held_ += drawn.points < wanted ? 1 : 0;
    }
  }
  now_.push_back(drawn);
  return drawn.points;
}

void Fade::end(const View& view, std::span<const std::uint32_t> hidden) {
  lastVolume_.emplace(view);
  lastHidden_.assign(hidden.begin(), hidden.end());
  std::sort(lastHidden_.begin(), lastHidden_.end());
}

}  // namespace strata
