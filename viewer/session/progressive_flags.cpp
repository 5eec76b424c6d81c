#include "viewer/session/progressive_flags.h"

#include <CLI/CLI.hpp>
#include <cmath>

#include "core/error.h"
#include "viewer/session/draw_flags.h"

namespace strata {
namespace {

constexpr double kMillion = 1e6;
constexpr double kLeast = 0.001, kMost = 4000.0;  // millions
constexpr double kPoolOverBudget = 1.25;          // rounding to pieces, and nodes that are out of view

}  // namespace

void addProgressiveFlags(CLI::App& app, ProgressiveFlags& flags) {
  app.add_option("--progressive", flags.millions,
                 "draw at most N million points a frame beside those of the last one, until all are there")
      ->check(CLI::Range(kLeast, kMost));
  app.add_option("--pool", flags.poolMillions,
                 "million points that the pool of --progressive holds (default: the point budget, or all points, and a "
                 "quarter)")
      ->check(CLI::Range(kLeast, kMost));
}

void checkProgressive(const ProgressiveFlags& flags, const std::string& backend, const DrawFlags& draw) {
  if (flags.millions == 0.0) {
    if (flags.poolMillions > 0.0) throw UsageError("--pool needs --progressive");
    return;
  }
  if (backend != "auto") throw UsageError("--progressive has a way of drawing of its own: no --backend " + backend);
  if (draw.shading != "plain") throw UsageError("--progressive shades plainly: no --shading " + draw.shading);
  if (draw.colour == "overdraw") throw UsageError("--progressive does not count overdraw: no --colour overdraw");
}

std::optional<ProgressiveOptions> progressiveOptions(const ProgressiveFlags& flags, std::uint64_t pointBudget,
                                                     std::uint64_t points) {
  if (flags.millions == 0.0) return std::nullopt;
  ProgressiveOptions options;
  const double most = kPoolOverBudget * static_cast<double>(std::min(pointBudget, points));
  options.pointsPerFrame = static_cast<std::uint64_t>(std::llround(flags.millions * kMillion));
  options.uploadPerFrame = std::max<std::uint64_t>(options.pointsPerFrame / 2, 1);
  options.poolPoints = static_cast<std::uint64_t>(
      std::llround(flags.poolMillions > 0.0 ? flags.poolMillions * kMillion : std::max(most, kLeast * kMillion)));
  return options;
}

}  // namespace strata
