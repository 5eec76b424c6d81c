#include "render/flood_splats.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace strata {
namespace {

constexpr std::uint32_t kNone = FloodSeeds::kNone;
constexpr std::size_t kSeedsAtOnce = 1024;
constexpr int kStripRows = 16;
constexpr float kOverlap = 1.0f;       ///< radius over the median distance, with neighbours all around
constexpr float kMostSpacings = 2.5f;  ///< largest radius in spacings where the seeds are next to each other:
constexpr float kNextPixels = 4.0f;    ///< a median distance below this says only that the picture has no more pixels
constexpr float kRound = 1.5f;         ///< ratio of axes up to which a splat is a circle: chance makes such too
constexpr float kMostStretch = 3.0f;   ///< of an ellipse
constexpr float kOpenSide = 2.0f;      ///< how much shorter a splat is towards where it has no neighbours
constexpr int kFewestNeighbours = 2;   ///< fewer are an outlier
constexpr float kLeastPixels = 0.5f;   ///< radius
constexpr float kDepthShare = 0.01f;   ///< of the depth: what is no farther apart is one surface
constexpr float kFlat = 0.05f;         ///< share of the second axis in the first, below which neighbours are a line
constexpr float kFar = std::numeric_limits<float>::infinity();

/// Eigenvectors of a symmetric matrix as columns, by falling eigenvalue (cyclic Jacobi).
struct Axes {
  glm::mat3 vectors;
  glm::vec3 values;
};
Axes axesOf(glm::mat3 m) {
  glm::mat3 v(1.0f);
  for (int sweep = 0; sweep < 6; ++sweep)
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (std::abs(m[p][q]) < 1e-20f) continue;
        const float theta = (m[q][q] - m[p][p]) / (2.0f * m[p][q]);
        const float t = (theta < 0.0f ? -1.0f : 1.0f) / (std::abs(theta) + std::sqrt(theta * theta + 1.0f));
        const float c = 1.0f / std::sqrt(t * t + 1.0f), s = t * c;
        glm::mat3 turn(1.0f);
        turn[p][p] = turn[q][q] = c;
        turn[q][p] = s;
        turn[p][q] = -s;
        m = glm::transpose(turn) * m * turn;
        v = v * turn;
      }
  int order[3] = {0, 1, 2};
  std::sort(order, order + 3, [&m](int a, int b) { return m[a][a] > m[b][b]; });
  Axes axes;
  for (int i = 0; i < 3; ++i) {
    axes.vectors[i] = v[order[i]];
    axes.values[i] = m[order[i]][order[i]];
  }
  return axes;
}

/// Rays of a view in the camera's frame.
struct Rays {
  explicit Rays(const View& view)
      : perspective(!view.orthographic),
        perPixel(static_cast<float>(1.0 / pixelsAt(view, 1.0, 1.0))),
        middleX(0.5f * static_cast<float>(view.width)),
        middleY(0.5f * static_cast<float>(view.height)) {}

  /// Metres at depth 1 to the right and up of the middle of pixel (x, y).
  glm::vec2 at(int x, int y) const {
    return {(static_cast<float>(x) + 0.5f - middleX) * perPixel, (middleY - static_cast<float>(y) - 0.5f) * perPixel};
  }
  /// Pixel coordinates of a point.
  glm::vec2 pixel(const glm::vec3& p) const {
    const float scale = 1.0f / (perPixel * (perspective ? p.z : 1.0f));
    return {middleX + p.x * scale, middleY - p.y * scale};
  }
  float pixels(float metres, float depth) const { return metres / (perPixel * (perspective ? depth : 1.0f)); }

  bool perspective;
  float perPixel;
  float middleX, middleY;
};

/// The offsets of a seed's neighbours.
struct Around {
  glm::vec3 offset[kFloodNeighbours];
  float distance[kFloodNeighbours];  ///< rising
  int count = 0;
  std::uint32_t open = 0;  ///< sectors without a neighbour
};

Around lookAround(const FloodSeeds& seeds, const FloodSeed& seed, const FloodNeighbours& neighbours, bool sectors) {
  Around around;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    if (neighbours[i] == kNone) {
      if (sectors) around.open |= 1u << i;
      continue;
    }
    const glm::vec3 offset = seeds.seeds[neighbours[i]].position - seed.position;
    const float distance = glm::length(offset);
    int place = around.count++;
    around.offset[place] = offset;
    for (; place > 0 && around.distance[place - 1] > distance; --place)
      around.distance[place] = around.distance[place - 1];
    around.distance[place] = distance;
  }
  return around;
}

float median(const float* sorted, int count) { return 0.5f * (sorted[(count - 1) / 2] + sorted[count / 2]); }

glm::vec3 towardsEye(const glm::vec3& position, bool perspective) {
  return perspective ? -glm::normalize(position) : glm::vec3(0.0f, 0.0f, -1.0f);
}

/// Of the plane through the neighbours; around a line the one that faces the eye.
glm::vec3 planeNormal(const Around& around, const glm::vec3& toEye) {
  glm::mat3 moments(0.0f);
  for (int i = 0; i < around.count; ++i) moments += glm::outerProduct(around.offset[i], around.offset[i]);
  const float size = moments[0][0] + moments[1][1] + moments[2][2];
  if (around.count < 2 || !(size > 0.0f)) return toEye;
  const Axes axes = axesOf(moments / size);
  if (axes.values[1] > kFlat * axes.values[0]) {
    const glm::vec3 normal = axes.vectors[2];
    return glm::dot(normal, toEye) < 0.0f ? -normal : normal;
  }
  const glm::vec3 facing = toEye - axes.vectors[0] * glm::dot(axes.vectors[0], toEye);
  return glm::length(facing) > 0.1f ? glm::normalize(facing) : toEye;
}

/// Two directions in the plane, as long as the inverse of the radius along them.
void shape(const Around& around, float radius, bool ellipse, FloodSplat& splat) {
  const glm::vec3 other = std::abs(splat.normal.z) < 0.9f ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
  const glm::vec3 u = glm::normalize(glm::cross(splat.normal, other)), v = glm::cross(splat.normal, u);
  float stretch = 1.0f, angle = 0.0f;
  if (ellipse) {
    float uu = 0.0f, uv = 0.0f, vv = 0.0f;
    for (int i = 0; i < around.count; ++i) {
      const float a = glm::dot(around.offset[i], u), b = glm::dot(around.offset[i], v);
      uu += a * a;
      uv += a * b;
      vv += b * b;
    }
    const float middle = 0.5f * (uu + vv), spread = std::hypot(0.5f * (uu - vv), uv);
    angle = 0.5f * std::atan2(2.0f * uv, uu - vv);
    // The ratio of the axes is the root of that of the moments; the area stays.
    const float least = (middle + spread) / (kMostStretch * kMostStretch);
    const float ratio = (middle + spread) / std::max(middle - spread, std::max(least, 1e-30f));
    if (ratio > kRound * kRound) stretch = std::pow(ratio, 0.25f);
  }
  const glm::vec3 longer = std::cos(angle) * u + std::sin(angle) * v;
  splat.radius = radius * stretch;
  splat.across = longer / splat.radius;
  splat.along = glm::cross(splat.normal, longer) * (stretch / radius);
}

class SplatMaker {
 public:
  SplatMaker(const FloodSeeds& seeds, const View& view, const FloodSettings& settings)
      : seeds_(seeds), settings_(settings), rays_(view) {}

  /// False where there is none.
  bool make(std::uint32_t index, const FloodNeighbours& neighbours, FloodSplat& splat) const {
    const FloodSeed& seed = seeds_.seeds[index];
    const Around around = lookAround(seeds_, seed, neighbours, settings_.sectors);
    if (around.count == 0 || (settings_.sectors && around.count < kFewestNeighbours)) return false;
    const float median = strata::median(around.distance, around.count);
    float radius = median;
    if (settings_.sectors) {
      radius = kOverlap * median;
      if (rays_.pixels(median, seed.position.z) < kNextPixels) radius = std::min(radius, kMostSpacings * seed.spacing);
    }
    if (!(radius > 0.0f) || median > seed.reach || median > settings_.relativeRadius * around.distance[0]) return false;
    if (rays_.pixels(radius, seed.position.z) < kLeastPixels) return false;
    splat.centre = seed.position;
    splat.from = seed.from;
    splat.openSectors = around.open;
    splat.normal = seed.normal;
    if (seed.normal == glm::vec3(0.0f)) {
      const glm::vec3 toEye = towardsEye(seed.position, rays_.perspective);
      splat.normal = settings_.estimateNormals ? planeNormal(around, toEye) : toEye;
    }
    shape(around, radius, settings_.ellipses, splat);
    return true;
  }

 private:
  const FloodSeeds& seeds_;
  const FloodSettings& settings_;
  Rays rays_;
};

/// Pixels [left, right] x [top, bottom] that a splat may touch; none where right < left.
struct Bounds {
  int left, right, top, bottom;
};

Bounds boundsOf(const FloodSplat& splat, const Rays& rays, int width, int height) {
  const glm::vec3 reach = splat.radius * glm::sqrt(glm::max(1.0f - splat.normal * splat.normal, 0.0f));
  const float nearest = std::max(splat.centre.z - reach.z, 0.2f * splat.centre.z);
  glm::vec2 lo(kFar), hi(-kFar);
  for (const float z : {nearest, splat.centre.z + reach.z})
    for (const float side : {-1.0f, 1.0f}) {
      const glm::vec2 pixel =
          rays.pixel({splat.centre.x + side * reach.x, splat.centre.y - side * reach.y, z});  // y points up
      lo = glm::min(lo, pixel);
      hi = glm::max(hi, pixel);
    }
  const auto column = [width](float x) { return static_cast<int>(std::clamp(x, -1.0f, static_cast<float>(width))); };
  const auto row = [height](float y) { return static_cast<int>(std::clamp(y, -1.0f, static_cast<float>(height))); };
  return {std::max(column(lo.x), 0), std::min(column(hi.x), width - 1), std::max(row(lo.y), 0),
          std::min(row(hi.y), height - 1)};
}

/// What the splats give one pixel.
struct Blend {
  float front = kFar, slack = 0.0f;  ///< of the nearest splat: its depth, and how much farther is the same surface
  float red = 0.0f, green = 0.0f, blue = 0.0f, depth = 0.0f, weight = 0.0f, heaviest = 0.0f;
  std::uint32_t from = kNone;  ///< the heaviest's
};

/// Draws the splats of a strip of rows, in their order.
class StripPainter {
 public:
  StripPainter(const std::vector<FloodSplat>& splats, const Rays& rays, const FloodSettings& settings,
               const Frame& source, int top, int bottom)
      : splats_(splats), rays_(rays), settings_(settings), source_(source), top_(top), bottom_(bottom) {
    blends_.resize(static_cast<std::size_t>(source.width) * static_cast<std::size_t>(bottom - top));
  }

  void findFront(std::uint32_t index) {
    const FloodSplat& splat = splats_[index];
    forEachFragment(splat, [&](std::size_t i, float depth, float) {
      Blend& blend = blends_[i];
      if (depth < blend.front) {
        blend.front = depth;
        blend.slack = std::max(kDepthShare * depth, splat.radius);
      }
    });
  }

  void blend(std::uint32_t index) {
    const FloodSplat& splat = splats_[index];
    const std::uint32_t colour = source_.colour[splat.from];
    forEachFragment(splat, [&](std::size_t i, float depth, float distance2) {
      Blend& blend = blends_[i];
      if (depth > blend.front + blend.slack || !hidden(i)) return;
      const float weight = std::exp(-distance2);
      blend.red += weight * static_cast<float>(colour & 255u);
      blend.green += weight * static_cast<float>(colour >> 8 & 255u);
      blend.blue += weight * static_cast<float>(colour >> 16 & 255u);
      blend.depth += weight * depth;
      blend.weight += weight;
      if (weight > blend.heaviest) {
        blend.heaviest = weight;
        blend.from = splat.from;
      }
    });
  }

  /// Returns how many pixels it changed.
  std::uint64_t write(Frame& frame) const {
    std::uint64_t filled = 0;
    for (std::size_t i = 0; i < blends_.size(); ++i) {
      const Blend& blend = blends_[i];
      if (!(blend.weight > 0.0f)) continue;
      const std::size_t pixel = i + first();
      const auto mean = [&](float sum) { return static_cast<std::uint32_t>(sum / blend.weight + 0.5f); };
      frame.colour[pixel] = mean(blend.red) | mean(blend.green) << 8 | mean(blend.blue) << 16 | 0xff000000u;
      frame.depth[pixel] = blend.depth / blend.weight;
      frame.pointId[pixel] = source_.pointId[blend.from];
      ++filled;
    }
    return filled;
  }

 private:
  std::size_t first() const { return static_cast<std::size_t>(top_) * static_cast<std::size_t>(source_.width); }
  bool hidden(std::size_t i) const {
    if (!settings_.keepFront) return true;
    return !(source_.depth[i + first()] <= blends_[i].front + blends_[i].slack);
  }

  /// Calls visit(pixel in the strip, depth, squared distance from the centre in radii).
  template <typename Visit>
  void forEachFragment(const FloodSplat& splat, Visit visit) const {
    const Bounds bounds = boundsOf(splat, rays_, source_.width, source_.height);
    const glm::vec2 middle = rays_.pixel(splat.centre);
    const float ahead = glm::dot(splat.normal, splat.centre);
    for (int y = std::max(bounds.top, top_); y <= std::min(bounds.bottom, bottom_ - 1); ++y)
      for (int x = bounds.left; x <= bounds.right; ++x) {
        const glm::vec2 ray = rays_.at(x, y);
        glm::vec3 hit;
        if (rays_.perspective) {
          const glm::vec3 direction(ray, 1.0f);
          hit = direction * (ahead / glm::dot(splat.normal, direction));
        } else {
          hit = glm::vec3(ray, (ahead - splat.normal.x * ray.x - splat.normal.y * ray.y) / splat.normal.z);
        }
        const glm::vec3 offset = hit - splat.centre;
        const float a = glm::dot(offset, splat.across), b = glm::dot(offset, splat.along);
        float distance2 = a * a + b * b;
        if (!(distance2 <= 1.0f) || !(hit.z > 0.0f)) continue;
        const int sector =
            floodSector(static_cast<float>(x) + 0.5f - middle.x, static_cast<float>(y) + 0.5f - middle.y);
        if ((splat.openSectors >> sector & 1u) != 0 && (distance2 *= kOpenSide * kOpenSide) > 1.0f) continue;
        visit(
            static_cast<std::size_t>(y - top_) * static_cast<std::size_t>(source_.width) + static_cast<std::size_t>(x),
            hit.z, distance2);
      }
  }

  const std::vector<FloodSplat>& splats_;
  const Rays& rays_;
  const FloodSettings& settings_;
  const Frame& source_;  ///< before filling
  int top_, bottom_;     ///< rows [top, bottom)
  std::vector<Blend> blends_;
};

}  // namespace

std::vector<FloodSplat> makeSplats(const FloodSeeds& seeds, const std::vector<FloodNeighbours>& neighbours,
                                   const View& view, const FloodSettings& settings, const ThreadPool& pool) {
  const SplatMaker maker(seeds, view, settings);
  const std::size_t parts = (seeds.seeds.size() + kSeedsAtOnce - 1) / kSeedsAtOnce;
  std::vector<std::vector<FloodSplat>> made(parts);
  pool.parallelFor(parts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part)
      for (std::size_t s = part * kSeedsAtOnce; s < std::min((part + 1) * kSeedsAtOnce, seeds.seeds.size()); ++s) {
        FloodSplat splat;
        if (maker.make(static_cast<std::uint32_t>(s), neighbours[s], splat)) made[part].push_back(splat);
      }
  });
  std::vector<FloodSplat> splats;
  for (const auto& part : made) splats.insert(splats.end(), part.begin(), part.end());
  return splats;
}

std::uint64_t drawSplats(const std::vector<FloodSplat>& splats, const View& view, const FloodSettings& settings,
                         const ThreadPool& pool, Frame& frame) {
  if (splats.empty()) return 0;
  const Rays rays(view);
  const auto strips = static_cast<std::size_t>((frame.height + kStripRows - 1) / kStripRows);
  std::vector<std::vector<std::uint32_t>> inStrip(strips);
  for (std::uint32_t i = 0; i < splats.size(); ++i) {
    const Bounds bounds = boundsOf(splats[i], rays, frame.width, frame.height);
    if (bounds.right < bounds.left) continue;
    for (int strip = bounds.top / kStripRows; strip * kStripRows <= bounds.bottom; ++strip)
      inStrip[static_cast<std::size_t>(strip)].push_back(i);
  }
  std::atomic<std::uint64_t> filled{0};
  const Frame source = frame;
  pool.parallelFor(strips, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t strip = begin; strip < end; ++strip) {
      const int top = static_cast<int>(strip) * kStripRows;
      StripPainter painter(splats, rays, settings, source, top, std::min(top + kStripRows, frame.height));
      for (const std::uint32_t i : inStrip[strip]) painter.findFront(i);
      for (const std::uint32_t i : inStrip[strip]) painter.blend(i);
      filled += painter.write(frame);
    }
  });
  return filled;
}

}  // namespace strata
