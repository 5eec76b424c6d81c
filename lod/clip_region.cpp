#include "lod/clip_region.h"

#include <algorithm>
#include <cmath>

namespace strata {
namespace {

/// A share of a contour's size by which points may be drawn beside their place: at 10 bits they are drawn in the middle
/// of a step, and half a step is at most a 512th of half the box's side. Twice that is allowed for.
constexpr double kStep = 1.0 / 256.0;

bool isApart(const Contour& contour, const glm::dvec3& extent, double slack, const Box& box) {
  const glm::dvec3 between = glm::abs(contour.centre - box.centre());
  const glm::dvec3 half = 0.5 * box.size();
  if (glm::any(glm::greaterThan(between, half + extent))) return true;
  for (std::size_t a = 0; a < 3; ++a) {
    const double along = std::abs(glm::dot(contour.axis[a], contour.centre - box.centre()));
    if (along > contour.half[a] + slack + glm::dot(glm::abs(contour.axis[a]), half)) return true;
  }
  return false;
}

}  // namespace

bool mayBeLeftBy(const Clip& clip, const Contour& contour, double reach) {
  if (clip.empty()) return true;
  const double longest = std::hypot(contour.half[0], contour.half[1], contour.half[2]);
  const double slack = reach + kStep * (longest + reach);
  glm::dvec3 extent(slack);  // along the world's axes
  for (std::size_t a = 0; a < 3; ++a) extent += contour.half[a] * glm::abs(contour.axis[a]);

  const auto apart = [&](const Box& box) { return isApart(contour, extent, slack, box); };
  if (!clip.boxes.empty() && std::all_of(clip.boxes.begin(), clip.boxes.end(), apart)) return false;
  const std::size_t cutouts = std::min(clip.cutouts.size(), Clip::kMost - std::min(clip.boxes.size(), Clip::kMost));
  for (std::size_t i = 0; i < cutouts; ++i)
    if (clip.cutouts[i].contains(contour.centre - extent) && clip.cutouts[i].contains(contour.centre + extent))
      return false;
  for (std::size_t i = 0; i < std::min(clip.planes.size(), Clip::kMost); ++i) {
    const glm::dvec3 normal(clip.planes[i]);
    if (glm::dot(normal, contour.centre) + clip.planes[i].w + glm::dot(glm::abs(normal), extent) < 0.0) return false;
  }
  return true;
}

}  // namespace strata
