#pragma once
#include <bitset>
#include <cstdint>
#include <optional>

#include <glm/glm.hpp>

#include "core/draw_options.h"
#include "core/picture.h"
#include "viewer/tools/profile.h"

namespace strata {

/// The part of a profile that a picture shows: the distance along the line grows to the right, the height upwards.
struct ProfileWindow {
  double left = 0.0, bottom = 0.0;  ///< metres at the picture's left lower corner
  glm::dvec2 metresPerPixel{0.01};  ///< along, height
  int width = 1, height = 1;        ///< pixels

  bool operator==(const ProfileWindow&) const = default;
};

/// A window on the whole profile with a margin, its heights stretched by `stretch`.
ProfileWindow fitProfile(const Profile& profile, int width, int height, double stretch);
glm::dvec2 metresAt(const ProfileWindow& window, const glm::dvec2& pixel);
glm::dvec2 pixelOfProfile(const ProfileWindow& window, const glm::dvec2& metres);
/// Goes nearer for `factor` < 1. The place under the pixel stays there.
ProfileWindow zoomedProfile(const ProfileWindow& window, const glm::dvec2& pixel, double factor);
ProfileWindow pannedProfile(const ProfileWindow& window, const glm::dvec2& dragPx);
/// Changes the size in pixels. The scale and the upper left corner stay.
ProfileWindow resizedProfile(const ProfileWindow& window, int width, int height);

/// Each pixel shows the point that lies furthest to the right of the line: the slab is seen from there.
/// Picture::pointId is its index in Profile::points, Picture::depth how far left of the slab's right side it lies.
/// Colour modes that a profile does not have (normals, ...) are shown as elevation.
void drawProfile(const Profile& profile, const ProfileWindow& window, const DrawOptions& options, Picture& frame);

/// The index in Profile::points of the point that is drawn nearest to the pixel, within `reach` pixels.
std::optional<std::uint32_t> profilePointAt(const Picture& frame, const glm::dvec2& pixel, int reach);

}  // namespace strata
