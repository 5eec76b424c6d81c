#include "render/picture/point_colour.h"

#include <algorithm>
#include <cmath>

#include "render/picture/colour_map.h"

namespace strata {
namespace {

std::uint32_t intensityColour(std::uint16_t intensity, const glm::vec2& range) {
  const float span = std::max(range.y - range.x, 1e-6f);
  const float t = (static_cast<float>(intensity) - range.x) / span;
  // Intensities span decades, and most of a scan lies in the darkest tenth of the range. The square root spreads it.
  const int grey = static_cast<int>(std::sqrt(std::clamp(t, 0.0f, 1.0f)) * 255.0f + 0.5f);
  return packColour(grey, grey, grey);
}

}  // namespace

const Batch& batchOf(const NodeData& node, std::uint32_t point) {
  const auto after = std::upper_bound(node.batches.begin(), node.batches.end(), point,
                                      [](std::uint32_t p, const Batch& batch) { return p < batch.firstPoint; });
  return *(after - 1);
}

std::uint32_t pointColour(const NodeData& node, std::uint32_t point, const DrawOptions& options, Precision precision) {
  switch (options.colour) {
    case ColourMode::rgb:
    case ColourMode::overdraw:
      return node.colour.empty() ? missingColour() : node.colour[point];
    case ColourMode::intensity:
      return node.intensity.empty() ? missingColour() : intensityColour(node.intensity[point], options.intensityRange);
    case ColourMode::elevation: {
      const auto loaded = static_cast<Precision>(node.loadedPlanes());
      const double z = pointPosition(node, batchOf(node, point), point, loaded).z;
      const double span = std::max(options.elevationRange.y - options.elevationRange.x, 1e-9);
      return elevationColour((z - options.elevationRange.x) / span);
    }
    case ColourMode::classification:
      return node.classification.empty() ? missingColour() : classificationColour(node.classification[point]);
    case ColourMode::level:
      return levelColour(node.key.level());
    case ColourMode::returnNumber:
      return node.returnNumber.empty() ? missingColour() : returnColour(node.returnNumber[point]);
    case ColourMode::normal:
      return node.normal.empty() ? missingColour() : normalColour(node.normal[point]);
    case ColourMode::precision:
      return precisionColour(static_cast<int>(precision));
  }
  return missingColour();
}

void pointColours(const NodeData& node, std::uint32_t firstPoint, const DrawOptions& options, Precision precision,
                  std::span<std::uint32_t> out) {
  if (options.colour == ColourMode::rgb && !node.colour.empty()) {
    std::copy_n(node.colour.data() + firstPoint, out.size(), out.begin());
    return;
  }
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = pointColour(node, firstPoint + static_cast<std::uint32_t>(i), options, precision);
}

void prefetchColour(const NodeData& node, std::uint32_t point, ColourMode mode) {
  const auto ask = [point](const auto& column) {
    if (!column.empty()) __builtin_prefetch(&column[point]);
  };
  if (mode == ColourMode::rgb) ask(node.colour);
  if (mode == ColourMode::intensity) ask(node.intensity);
  if (mode == ColourMode::classification) ask(node.classification);
  if (mode == ColourMode::elevation) ask(node.position[0]);
  if (mode == ColourMode::returnNumber) ask(node.returnNumber);
  if (mode == ColourMode::normal) ask(node.normal);
}

}  // namespace strata
