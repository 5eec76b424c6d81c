#include "viewer/bench/jump_watch.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace strata {

void JumpWatch::begin(double t, double nowMs) {
  jumps_.push_back({t});
  sinceJump_.clear();
  beganMs_ = nowMs;
}

void JumpWatch::look(const View& view) { sinceJump_.push_back(view); }

double JumpWatch::see(const RenderList& list, double nowMs) {
  if (std::find(sinceJump_.rbegin(), sinceJump_.rend(), list.view) == sinceJump_.rend()) return 0.0;
  const double wanted = static_cast<double>(list.items.size()) + list.missingNodes;
  const double fine = static_cast<double>(list.items.size()) - list.coarseNodes;
  const double detail = wanted > 0.0 ? fine / wanted : 1.0;
  if (!jumps_.empty())
    for (std::size_t i = 0; i < std::size(JumpRecord::kShares); ++i)
      if (double& reached = jumps_.back().reachedMs[i]; reached < 0.0 && detail >= JumpRecord::kShares[i])
        reached = nowMs - beganMs_;
  return detail;
}

std::vector<JumpRecord> medianJumps(std::span<const std::vector<JumpRecord>> runs) {
  std::vector<JumpRecord> medians = runs.empty() ? std::vector<JumpRecord>{} : runs.front();
  for (std::size_t jump = 0; jump < medians.size(); ++jump)
    for (std::size_t i = 0; i < std::size(JumpRecord::kShares); ++i) {
      std::vector<double> times;
      for (const std::vector<JumpRecord>& run : runs)
        times.push_back(run[jump].reachedMs[i] >= 0.0 ? run[jump].reachedMs[i] : std::numeric_limits<double>::max());
      std::sort(times.begin(), times.end());
      const double low = times[(times.size() - 1) / 2], high = times[times.size() / 2];
      medians[jump].reachedMs[i] = high == std::numeric_limits<double>::max() ? -1.0 : (low + high) / 2.0;
    }
  return medians;
}

}  // namespace strata
