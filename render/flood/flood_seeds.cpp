#include "render/flood/flood_seeds.h"

#include <algorithm>
#include <cmath>

#include "render/plan/point_location.h"

namespace strata {
namespace {

constexpr std::size_t kRowsAtOnce = 8;

glm::vec3 unpackNormal(std::uint32_t packed) {
  const auto part = [packed](int shift) {
    return static_cast<float>(static_cast<std::int8_t>(packed >> shift & 255u));
  };
  const glm::vec3 normal(part(0), part(8), part(16));
  const float length = glm::length(normal);
  return length > 0.0f ? normal / length : glm::vec3(0.0f);
}

/// The pixel of the nearest point in columns 2x and 2x + 1 of rows 2y and 2y + 1; of equally near ones the first.
FloodPixel nearestOfFour(const Picture& picture, int x, int y) {
  FloodPixel nearest = kNoPixel;
  float depth = 0.0f;
  for (int v = 2 * y; v < std::min(2 * y + 2, picture.height); ++v)
    for (int u = 2 * x; u < std::min(2 * x + 2, picture.width); ++u) {
      const auto i =
          static_cast<std::size_t>(v) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(u);
      if (picture.pointId[i] == Picture::kNoPoint || (nearest != kNoPixel && !(picture.depth[i] < depth))) continue;
      nearest = floodPixel(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v));
      depth = picture.depth[i];
    }
  return nearest;
}

}  // namespace

std::uint32_t packFloodNormal(const glm::vec3& normal) {
  if (normal == glm::vec3(0.0f)) return 0;
  const glm::uvec3 parts(normal * 511.0f + 512.5f);
  return parts.x | parts.y << 10 | parts.z << 20;
}

glm::vec3 unpackFloodNormal(std::uint32_t packed) {
  if (packed == 0) return glm::vec3(0.0f);
  return (glm::vec3(packed & 1023u, packed >> 10 & 1023u, packed >> 20) - 512.0f) / 511.0f;
}

FloodLens floodLens(const View& view) {
  View whole = wholePicture(view);
  whole.nearPlane = 0.0;  // pixelsAt() takes no depth in front of it
  return {!view.orthographic, static_cast<float>(1.0 / pixelsAt(whole, 1.0, 1.0)),
          0.5f * static_cast<float>(whole.width) - static_cast<float>(view.tile.left),
          0.5f * static_cast<float>(whole.height) - static_cast<float>(view.tile.top)};
}

float drawnSpacing(const NodeData& node, std::uint32_t drawn) {
  const auto count = static_cast<float>(std::max(node.pointCount(), 1u));
  float spacing = node.spacing;
  if (!(spacing > 0.0f) && !node.batches.empty()) {
    glm::dvec3 lo = node.batches.front().boxMin, hi = lo;
    for (const Batch& batch : node.batches) {
      lo = glm::min(lo, batch.boxMin);
      hi = glm::max(hi, batch.boxMin + batch.boxSize);
    }
    const glm::dvec3 size = hi - lo;
    const double area = std::max({size.x * size.y, size.y * size.z, size.z * size.x});
    spacing = static_cast<float>(std::sqrt(area / static_cast<double>(count)));
  }
  return spacing * std::sqrt(count / static_cast<float>(std::clamp(drawn, 1u, std::max(node.pointCount(), 1u))));
}

std::vector<float> floodReaches(const RenderList& list, const FloodSettings& settings) {
  std::vector<float> reaches;
  for (const RenderItem& item : list.items)
    reaches.push_back(settings.reachMetres > 0.0f ? settings.reachMetres
                                                  : settings.reachSpacings * drawnSpacing(*item.node, item.pointCount));
  return reaches;
}

FloodSeeds collectSeeds(const RenderList& list, const View& view, const FloodSettings& settings, const Picture& picture,
                        const ThreadPool& pool) {
  FloodSeeds out;
  out.lens = floodLens(view);
  if (picture.width > kFloodLargestSide || picture.height > kFloodLargestSide) return out;
  out.width = (picture.width + 1) / 2;
  out.height = (picture.height + 1) / 2;
  const auto width = static_cast<std::size_t>(out.width), height = static_cast<std::size_t>(out.height);
  const bool normals =
      settings.useNormals && std::any_of(list.items.begin(), list.items.end(),
                                         [](const RenderItem& item) { return !item.node->normal.empty(); });
  out.at.resize(width * height);
  out.points.resize(width * height);
  if (normals) out.normals.assign(width * height, 0);
  const PointFinder finder(list);
  const std::vector<float> reaches = floodReaches(list, settings);
  const ViewBasis basis = viewBasis(view);
  const glm::mat3 toCamera(glm::transpose(glm::dmat3(basis.right, basis.up, basis.forward)));
  pool.parallelFor(height, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * width; i < end * width; ++i) {
      const FloodPixel seed = nearestOfFour(picture, static_cast<int>(i % width), static_cast<int>(i / width));
      out.at[i] = seed;
      out.points[i] = {};
      if (seed == kNoPixel) continue;
      const std::size_t pixel = static_cast<std::size_t>(pixelRow(seed)) * static_cast<std::size_t>(picture.width) +
                                static_cast<std::size_t>(pixelColumn(seed));
      const PointLocation location = finder.find(picture.pointId[pixel]);
      const float depth = picture.depth[pixel];
      // Seeds in neighbouring pixels must reach each other, however fine the scan is.
      const float least = settings.sectors ? kFloodNextPixels * out.lens.metres(depth) : 0.0f;
      out.points[i] = {depth, std::max(reaches[location.item], least)};
      if (!normals || location.node->normal.empty()) continue;
      const glm::vec3 normal = toCamera * unpackNormal(location.node->normal[location.index]);
      const glm::vec3 away = out.lens.perspective ? out.lens.position(seed, depth) : glm::vec3(0.0f, 0.0f, 1.0f);
      out.normals[i] = packFloodNormal(glm::dot(normal, away) > 0.0f ? -normal : normal);
    }
  });
  return out;
}

}  // namespace strata
