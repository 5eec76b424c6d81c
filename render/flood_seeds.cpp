#include "render/flood_seeds.h"

#include <algorithm>
#include <cmath>

#include "render/point_colour.h"
#include "render/point_place.h"

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

/// Turns points of a frame into seeds.
class SeedMaker {
 public:
  SeedMaker(const RenderList& list, const View& view, const FloodSettings& settings)
      : finder_(list), settings_(settings), eye_(view.eye) {
    const ViewBasis basis = viewBasis(view);
    toCamera_ = glm::transpose(glm::dmat3(basis.right, basis.up, basis.forward));
    perspective_ = !view.orthographic;
    halfPixels_ = static_cast<float>(pixelsAt(view, 1.0, 1.0) / 2.0);
    for (const RenderItem& item : list.items) spacings_.push_back(drawnSpacing(*item.node, item.pointCount));
  }

  FloodSeed make(std::uint32_t id) const {
    const PointPlace place = finder_.find(id);
    const NodeData& node = *place.node;
    const auto loaded = static_cast<Precision>(node.loadedPlanes());
    FloodSeed seed{};
    seed.position =
        glm::vec3(toCamera_ * (pointPosition(node, batchOf(node, place.index), place.index, loaded) - eye_));
    seed.spacing = spacings_[place.item];
    seed.reach = settings_.reachMetres > 0.0f ? settings_.reachMetres : settings_.reachSpacings * seed.spacing;
    seed.reachPx = seed.reach * halfPixels_ / (perspective_ ? seed.position.z : 1.0f);
    if (settings_.useNormals && !node.normal.empty()) {
      const glm::vec3 normal(toCamera_ * glm::dvec3(unpackNormal(node.normal[place.index])));
      const glm::vec3 towards = perspective_ ? -seed.position : glm::vec3(0.0f, 0.0f, -1.0f);
      seed.normal = glm::dot(normal, towards) < 0.0f ? -normal : normal;
    }
    return seed;
  }

 private:
  PointFinder finder_;
  const FloodSettings& settings_;
  glm::dvec3 eye_;
  glm::dmat3 toCamera_;
  bool perspective_ = true;
  float halfPixels_ = 0.0f;      ///< pixels of the half picture that a metre covers, at depth 1
  std::vector<float> spacings_;  ///< of the list's items
};

/// The pixel of the nearest point in columns 2x, 2x + 1 of rows 2y, 2y + 1.
std::uint32_t nearestOfFour(const Frame& frame, int x, int y) {
  std::uint32_t nearest = FloodSeeds::kNone;
  for (int v = 2 * y; v < std::min(2 * y + 2, frame.height); ++v)
    for (int u = 2 * x; u < std::min(2 * x + 2, frame.width); ++u) {
      const auto i = static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) + static_cast<std::size_t>(u);
      if (frame.pointId[i] == Frame::kNoPoint) continue;
      if (nearest == FloodSeeds::kNone || frame.depth[i] < frame.depth[nearest])
        nearest = static_cast<std::uint32_t>(i);
    }
  return nearest;
}

}  // namespace

FloodSettings faithfulFlood(float scale, float share) {
  FloodSettings settings;
  settings.reachMetres = share * scale;
  settings.continuity = 0.05f / share;
  settings.sectors = settings.estimateNormals = settings.ellipses = settings.keepFront = false;
  return settings;
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

FloodSeeds collectSeeds(const RenderList& list, const View& view, const FloodSettings& settings, const Frame& frame,
                        const ThreadPool& pool) {
  FloodSeeds out;
  out.width = (frame.width + 1) / 2;
  out.height = (frame.height + 1) / 2;
  const auto width = static_cast<std::size_t>(out.width), height = static_cast<std::size_t>(out.height);
  out.at.assign(width * height, FloodSeeds::kNone);
  std::vector<std::uint32_t> found(out.at.size());
  pool.parallelFor(height, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * width; i < end * width; ++i)
      found[i] = nearestOfFour(frame, static_cast<int>(i % width), static_cast<int>(i / width));
  });
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found[i] != FloodSeeds::kNone) out.at[i] = count++;
  out.seeds.resize(count);
  const SeedMaker maker(list, view, settings);
  pool.parallelFor(height, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * width; i < end * width; ++i) {
      if (out.at[i] == FloodSeeds::kNone) continue;
      FloodSeed& seed = out.seeds[out.at[i]] = maker.make(frame.pointId[found[i]]);
      seed.from = found[i];
      seed.x = static_cast<std::uint16_t>(i % width);
      seed.y = static_cast<std::uint16_t>(i / width);
    }
  });
  return out;
}

}  // namespace strata
