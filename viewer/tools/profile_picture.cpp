#include "viewer/tools/profile_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/picture/colour_map.h"

namespace strata {
namespace {

constexpr double kMargin = 0.05;       // of the picture on each side
constexpr double kLeastMetres = 1e-3;  // that a whole profile is taken to measure
constexpr double kFinestScale = 1e-6;  // metres a pixel
constexpr double kCoarsestScale = 1e5;

std::uint32_t colourOf(const ProfilePoint& point, const DrawOptions& options) {
  const auto share = [](double value, double low, double high) { return (value - low) / std::max(high - low, 1e-9); };
  switch (options.colour) {
    case ColourMode::rgb:
      if (point.colour != 0) return point.colour;
      break;
    case ColourMode::intensity: {
      const double t = share(point.intensity, static_cast<double>(options.intensityRange.x),
                             static_cast<double>(options.intensityRange.y));
      const int grey = static_cast<int>(std::lround(255.0 * std::clamp(t, 0.0, 1.0)));
      return packColour(grey, grey, grey);
    }
    case ColourMode::classification:
      return classificationColour(point.classification);
    case ColourMode::level:
      return levelColour(point.depth);
    default:
      break;
  }
  return elevationColour(share(point.position.z, options.elevationRange.x, options.elevationRange.y));
}

}  // namespace

ProfileWindow fitProfile(const Profile& profile, int width, int height, double stretch) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const ProfilePoint& p : profile.points) {
    low = std::min(low, p.position.z);
    high = std::max(high, p.position.z);
  }
  if (!(low <= high)) low = high = 0.0;
  const double length = std::max(slabLength(profile.slab), kLeastMetres);
  const double tall = std::max(high - low, kLeastMetres);
  ProfileWindow window;
  window.width = std::max(width, 1);
  window.height = std::max(height, 1);
  const double room = 1.0 - 2.0 * kMargin;
  const double scale = std::max(length / (room * window.width), stretch * tall / (room * window.height));
  window.metresPerPixel = {scale, scale / stretch};
  window.left = 0.5 * (length - scale * window.width);
  window.bottom = 0.5 * (low + high - window.metresPerPixel.y * window.height);
  return window;
}

glm::dvec2 metresAt(const ProfileWindow& window, const glm::dvec2& pixel) {
  return {window.left + pixel.x * window.metresPerPixel.x,
          window.bottom + (window.height - pixel.y) * window.metresPerPixel.y};
}

glm::dvec2 pixelOfProfile(const ProfileWindow& window, const glm::dvec2& metres) {
  return {(metres.x - window.left) / window.metresPerPixel.x,
          window.height - (metres.y - window.bottom) / window.metresPerPixel.y};
}

ProfileWindow zoomedProfile(const ProfileWindow& window, const glm::dvec2& pixel, double factor) {
  const glm::dvec2 scale = window.metresPerPixel * factor;
  if (std::min(scale.x, scale.y) < kFinestScale || std::max(scale.x, scale.y) > kCoarsestScale) return window;
  const glm::dvec2 fixed = metresAt(window, pixel);
  ProfileWindow next = window;
  next.metresPerPixel = scale;
  next.left = fixed.x - pixel.x * scale.x;
  next.bottom = fixed.y - (window.height - pixel.y) * scale.y;
  return next;
}

ProfileWindow pannedProfile(const ProfileWindow& window, const glm::dvec2& dragPx) {
  ProfileWindow next = window;
  next.left -= dragPx.x * window.metresPerPixel.x;
  next.bottom += dragPx.y * window.metresPerPixel.y;
  return next;
}

ProfileWindow resizedProfile(const ProfileWindow& window, int width, int height) {
  ProfileWindow next = window;
  next.width = std::max(width, 1);
  next.height = std::max(height, 1);
  next.bottom += (window.height - next.height) * window.metresPerPixel.y;
  return next;
}

void drawProfile(const Profile& profile, const ProfileWindow& window, const DrawOptions& options, Picture& frame) {
  frame.width = window.width;
  frame.height = window.height;
  const std::size_t pixels = static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height);
  const glm::u8vec3 back = options.background;
  frame.colour.assign(pixels, packColour(back.x, back.y, back.z));
  frame.depth.assign(pixels, std::numeric_limits<float>::infinity());
  frame.pointId.assign(pixels, Picture::kNoPoint);
  const int before = (std::clamp(options.pointSize, 1, DrawOptions::kLargestPoint) - 1) / 2;
  const int behind = std::clamp(options.pointSize, 1, DrawOptions::kLargestPoint) - 1 - before;
  for (std::size_t i = 0; i < profile.points.size(); ++i) {
    const ProfilePoint& point = profile.points[i];
    if (!options.classes[point.classification]) continue;
    const glm::dvec2 pixel = pixelOfProfile(window, {point.along, point.position.z});
    if (!(pixel.x > -behind - 1.0 && pixel.x < window.width + before + 1.0 && pixel.y > -behind - 1.0 &&
          pixel.y < window.height + before + 1.0))
      continue;
    const int column = static_cast<int>(std::floor(pixel.x)), row = static_cast<int>(std::floor(pixel.y));
    const float depth = static_cast<float>(point.across + 0.5 * profile.slab.width);
    const std::uint32_t colour = colourOf(point, options);
    for (int y = std::max(row - before, 0); y <= std::min(row + behind, window.height - 1); ++y)
      for (int x = std::max(column - before, 0); x <= std::min(column + behind, window.width - 1); ++x) {
        const std::size_t at =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(window.width) + static_cast<std::size_t>(x);
        if (!(depth < frame.depth[at])) continue;
        frame.depth[at] = depth;
        frame.pointId[at] = static_cast<std::uint32_t>(i);
        frame.colour[at] = colour;
      }
  }
}

std::optional<std::uint32_t> profilePointAt(const Picture& frame, const glm::dvec2& pixel, int reach) {
  const int column = static_cast<int>(std::floor(pixel.x)), row = static_cast<int>(std::floor(pixel.y));
  std::optional<std::uint32_t> nearest;
  int least = reach * reach + 1;
  for (int y = std::max(row - reach, 0); y <= std::min(row + reach, frame.height - 1); ++y)
    for (int x = std::max(column - reach, 0); x <= std::min(column + reach, frame.width - 1); ++x) {
      const std::uint32_t id = frame.pointId[static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.width) +
                                             static_cast<std::size_t>(x)];
      const int distance = (x - column) * (x - column) + (y - row) * (y - row);
      if (id == Picture::kNoPoint || distance >= least) continue;
      least = distance;
      nearest = id;
    }
  return nearest;
}

}  // namespace strata
