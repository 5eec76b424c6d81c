#include "viewer/tools/pick.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/error.h"
#include "core/scalar.h"
#include "io/store/node_codec.h"

namespace strata {
namespace {

constexpr int kMostDigits = 9;

std::string shortNumber(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.12g", value);
  return text;
}

}  // namespace

std::optional<glm::ivec2> drawnPixelAt(const Picture& picture, const glm::dvec2& pixel, int reach) {
  const int column = static_cast<int>(std::floor(pixel.x));
  const int row = static_cast<int>(std::floor(pixel.y));
  std::optional<glm::ivec2> best;
  int bestDistance = reach * reach + 1;
  float bestDepth = std::numeric_limits<float>::infinity();
  for (int y = std::max(0, row - reach); y <= std::min(picture.height - 1, row + reach); ++y)
    for (int x = std::max(0, column - reach); x <= std::min(picture.width - 1, column + reach); ++x) {
      const std::size_t at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x);
      if (picture.pointId[at] == Picture::kNoPoint) continue;
      const int distance = (x - column) * (x - column) + (y - row) * (y - row);
      if (distance > bestDistance || (distance == bestDistance && picture.depth[at] >= bestDepth)) continue;
      bestDistance = distance;
      bestDepth = picture.depth[at];
      best = {x, y};
    }
  return best;
}

std::optional<DrawnPoint> drawnPointAt(const RenderList& list, const Picture& picture, const glm::dvec2& pixel,
                                       int reach) {
  const auto at = drawnPixelAt(picture, pixel, reach);
  if (!at) return std::nullopt;
  std::uint32_t id = picture.pointId[static_cast<std::size_t>(at->y) * static_cast<std::size_t>(picture.width) +
                                     static_cast<std::size_t>(at->x)];
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    if (id < list.items[i].pointCount) return DrawnPoint{i, id};
    id -= list.items[i].pointCount;
  }
  return std::nullopt;
}

std::string gridNumber(double value, double step) {
  int digits = 0;
  // A step such as 0.00025 needs more digits than its magnitude.
  for (double scaled = step; digits < kMostDigits && std::abs(scaled - std::round(scaled)) > 1e-6 * scaled; ++digits)
    scaled *= 10.0;
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string attributeText(const Attribute& attribute, const std::byte* value) {
  std::string text;
  for (std::uint16_t c = 0; c < attribute.components; ++c) {
    const double stored = loadScalar(value + c * scalarBytes(attribute.type), attribute.type);
    if (c > 0) text.push_back(' ');
    text += shortNumber(stored * attribute.scale + attribute.offset);
  }
  return text;
}

PickedPoint lookUpPoint(const Store& store, std::uint32_t index, std::uint32_t point) {
  const StoreInfo& info = store.info();
  const std::string node = NodeKey{store.hierarchy().nodes[index].key}.text();
  const NodePoints points = readAll(store, index);
  if (point >= points.count()) throw Error(store.path(), "node " + node + " has no point " + std::to_string(point));
  PickedPoint picked;
  const glm::dvec3 steps(points.grid[0][point], points.grid[1][point], points.grid[2][point]);
  picked.position = info.grid.offset + info.grid.scale * steps;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) picked.coordinates.push_back(' ');
    picked.coordinates += gridNumber(picked.position[axis], info.grid.scale[axis]);
  }
  const std::byte* record = points.attributes.data() + point * info.layout.stride();
  const std::vector<Attribute>& attributes = info.layout.attributes();
  for (std::size_t a = 0; a < attributes.size(); ++a)
    if (!attributes[a].isInternal())
      picked.facts.emplace_back(attributes[a].name, attributeText(attributes[a], record + info.layout.offset(a)));
  picked.facts.emplace_back("node", node + ", point " + std::to_string(point));
  picked.facts.emplace_back("store", store.path());
  if (info.sources.size() == 1) picked.facts.emplace_back("source", info.sources.front().path);
  return picked;
}

}  // namespace strata
