#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "render/progressive/progressive_rasterizer.h"

namespace CLI {
class App;
}

namespace strata {

struct DrawFlags;

/// The options of the command line about progressive drawing; the same for strata-bench and strata-view.
struct ProgressiveFlags {
  double millions = 0.0;      ///< points of the pool that a frame draws; 0: not progressive
  double poolMillions = 0.0;  ///< 0: the point budget, or all points if they are fewer, plus a quarter
};

void addProgressiveFlags(CLI::App& app, ProgressiveFlags& flags);

/// Throws UsageError when other options ask for something that progressive drawing cannot do.
void checkProgressive(const ProgressiveFlags& flags, const std::string& backend, const DrawFlags& draw);

/// The options of progressive drawing for stores that hold `points` points together; none where the flags do not ask
/// for it.
std::optional<ProgressiveOptions> progressiveOptions(const ProgressiveFlags& flags, std::uint64_t pointBudget,
                                                     std::uint64_t points);

}  // namespace strata
