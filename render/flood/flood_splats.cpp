#include "render/flood/flood_splats.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "render/flood/splat_kernel.h"

namespace strata {
namespace {

constexpr std::size_t kRowsAtOnce = 8;
constexpr int kStripRows = 16;
constexpr float kFar = std::numeric_limits<float>::infinity();

/// The direction that a symmetric matrix, whose rank is 2 at most up to rounding, maps to zero. Where the rank is lower
/// there is no single one, and the result is 0.
glm::vec3 kernelOf(const glm::mat3& m) {
  const glm::vec3 products[3] = {glm::cross(m[0], m[1]), glm::cross(m[0], m[2]), glm::cross(m[1], m[2])};
  glm::vec3 longest(0.0f);
  float length2 = 0.0f;
  for (const glm::vec3& product : products)
    if (glm::dot(product, product) > length2) {
      longest = product;
      length2 = glm::dot(product, product);
    }
  return length2 > 1e-20f ? longest / std::sqrt(length2) : glm::vec3(0.0f);
}

/// The eigenvalues of a symmetric matrix whose trace is 1, largest first: the roots of its characteristic polynomial,
/// by the trigonometric formula.
glm::vec3 eigenvalues(const glm::mat3& m) {
  const glm::vec3 diagonal = glm::vec3(m[0][0], m[1][1], m[2][2]) - 1.0f / 3.0f;
  const float beside = m[0][1] * m[0][1] + m[0][2] * m[0][2] + m[1][2] * m[1][2];
  const float spread = std::sqrt((glm::dot(diagonal, diagonal) + 2.0f * beside) / 6.0f);
  if (spread < 1e-6f) return glm::vec3(1.0f / 3.0f);
  const float half = 0.5f * glm::determinant((m - glm::mat3(1.0f / 3.0f)) / spread);
  const float angle = std::acos(std::clamp(half, -1.0f, 1.0f)) / 3.0f;
  const float first = 1.0f / 3.0f + 2.0f * spread * std::cos(angle);
  const float third = 1.0f / 3.0f + 2.0f * spread * std::cos(angle + 2.0943951f);
  return {first, 1.0f - first - third, third};
}

/// The neighbours of a seed, as offsets from it.
struct Around {
  glm::vec3 offset[kFloodNeighbours];
  float distance[kFloodNeighbours];  ///< ascending; not in the order of `offset`
  int count = 0;
  std::uint32_t open = 0;  ///< sectors without a neighbour
};

Around lookAround(const FloodSeeds& seeds, const glm::vec3& position, const FloodNeighbours& neighbours, bool sectors) {
  Around around;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    if (neighbours[i] == kNoPixel) {
      if (sectors) around.open |= 1u << i;
      continue;
    }
    const glm::vec3 offset = seeds.position(neighbours[i]) - position;
    const float distance = glm::length(offset);
    int at = around.count++;
    around.offset[at] = offset;
    for (; at > 0 && around.distance[at - 1] > distance; --at) around.distance[at] = around.distance[at - 1];
    around.distance[at] = distance;
  }
  return around;
}

float median(const float* sorted, int count) { return 0.5f * (sorted[(count - 1) / 2] + sorted[count / 2]); }

/// The normal of the plane through the seed and its neighbours. Where these form a line, the plane around it that faces
/// the eye most is taken.
glm::vec3 planeNormal(const Around& around, const glm::vec3& toEye) {
  glm::mat3 moments(0.0f);
  for (int i = 0; i < around.count; ++i) moments += glm::outerProduct(around.offset[i], around.offset[i]);
  const float size = moments[0][0] + moments[1][1] + moments[2][2];
  if (around.count < 2 || !(size > 0.0f)) return toEye;
  moments /= size;
  const glm::vec3 values = eigenvalues(moments);
  if (values.y > kFloodFlat * values.x) {
    const glm::vec3 normal = kernelOf(moments - glm::mat3(values.z));
    if (normal == glm::vec3(0.0f)) return toEye;
    return glm::dot(normal, toEye) < 0.0f ? -normal : normal;
  }
  const glm::vec3 line = kernelOf(moments - glm::mat3(values.x));
  const glm::vec3 facing = toEye - line * glm::dot(line, toEye);
  return glm::length(facing) > 0.1f ? glm::normalize(facing) : toEye;
}

/// The axes of a splat in space. Each is as long as the inverse of the radius along it.
struct Axes {
  glm::vec3 across, along;
  float radius;  ///< the longer one
};

Axes axesOf(const Around& around, const glm::vec3& normal, float radius, bool ellipse) {
  const glm::vec3 other = std::abs(normal.z) < 0.9f ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
  const glm::vec3 u = glm::normalize(glm::cross(normal, other)), v = glm::cross(normal, u);
  float stretch = 1.0f;
  glm::vec3 longer = u;
  if (ellipse) {
    float uu = 0.0f, uv = 0.0f, vv = 0.0f;
    for (int i = 0; i < around.count; ++i) {
      const float a = glm::dot(around.offset[i], u), b = glm::dot(around.offset[i], v);
      uu += a * a;
      uv += a * b;
      vv += b * b;
    }
    const float middle = 0.5f * (uu + vv), half = 0.5f * (uu - vv), spread = std::sqrt(half * half + uv * uv);
    // The ratio of the axes is the square root of the ratio of the moments, and the area stays.
    const float least = (middle + spread) / (kFloodMostStretch * kFloodMostStretch);
    const float ratio = (middle + spread) / std::max(middle - spread, std::max(least, 1e-30f));
    if (ratio > kFloodRound * kFloodRound) {
      stretch = std::sqrt(std::sqrt(ratio));
      const float cosine = half / spread;  // of twice the angle between u and the longer axis
      const float sine = std::sqrt(std::max(0.5f - 0.5f * cosine, 0.0f));
      longer = std::sqrt(std::max(0.5f + 0.5f * cosine, 0.0f)) * u + (uv < 0.0f ? -sine : sine) * v;
    }
  }
  return {longer / (radius * stretch), glm::cross(normal, longer) * (stretch / radius), radius * stretch};
}

class SplatMaker {
 public:
  SplatMaker(const FloodSeeds& seeds, const glm::ivec2& size, const FloodSettings& settings)
      : seeds_(seeds), lens_(seeds.lens), size_(size), settings_(settings) {}

  /// Shapes the splat of a seed. False where it gets none.
  bool make(FloodPixel seed, const FloodNeighbours& neighbours, FloodSplat& splat) const {
    const std::size_t index = seeds_.index(seed);
    const FloodPoint& point = seeds_.points[index];
    const glm::vec3 position = lens_.position(seed, point.depth);
    const Around around = lookAround(seeds_, position, neighbours, settings_.sectors);
    if (around.count == 0 || (settings_.sectors && around.count < kFloodFewestNeighbours)) return false;
    const float median = strata::median(around.distance, around.count), pixel = lens_.metres(point.depth);
    float radius = median, closest = around.distance[0];
    if (settings_.sectors) closest = std::max(closest, kFloodSeedPixels * pixel);
    if (settings_.sectors && median < kFloodNextPixels * pixel)
      radius = std::min(radius, kFloodMostSpacings / settings_.reachSpacings * point.reach);
    if (!(radius > 0.0f) || median > point.reach || median > settings_.relativeRadius * closest) return false;
    if (radius < kFloodLeastPixels * pixel) return false;
    const glm::vec3 toEye = lens_.perspective ? -glm::normalize(position) : glm::vec3(0.0f, 0.0f, -1.0f);
    glm::vec3 normal = seeds_.normals.empty() ? glm::vec3(0.0f) : unpackFloodNormal(seeds_.normals[index]);
    if (normal == glm::vec3(0.0f)) normal = settings_.estimateNormals ? planeNormal(around, toEye) : toEye;
    if (!(std::abs(glm::dot(normal, toEye)) > kFloodEdgeOn)) return false;
    splat.from = seed;
    splat.x = static_cast<float>(pixelColumn(seed)) + 0.5f;
    splat.y = static_cast<float>(pixelRow(seed)) + 0.5f;
    splat.openSectors = around.open;
    const Axes axes = axesOf(around, normal, radius, settings_.ellipses);
    splat.radius = axes.radius;
    project(position, normal, axes, splat);
    return bound(position, normal, splat);
  }

 private:
  /// Expresses where the plane of the splat meets the ray of a pixel as a function of the pixel; see FloodSplat.
  void project(const glm::vec3& centre, const glm::vec3& normal, const Axes& axes, FloodSplat& splat) const {
    const glm::vec2 perPixel(lens_.perPixel, -lens_.perPixel);
    const auto set = [perPixel](const glm::vec2& value, float& x, float& y) {
      x = value.x * perPixel.x;
      y = value.y * perPixel.y;
    };
    splat.centreDepth = centre.z;
    splat.tiltX = splat.tiltY = splat.slopeX = splat.slopeY = 0.0f;
    const glm::vec2 across(axes.across), along(axes.along), flat(normal);
    if (lens_.perspective) {
      const float ahead = glm::dot(normal, centre);
      set(flat * (centre.z / ahead), splat.tiltX, splat.tiltY);
      set(centre.z * (across - flat * (glm::dot(axes.across, centre) / ahead)), splat.acrossX, splat.acrossY);
      set(centre.z * (along - flat * (glm::dot(axes.along, centre) / ahead)), splat.alongX, splat.alongY);
    } else {
      set(-flat / normal.z, splat.slopeX, splat.slopeY);
      set(across - flat * (axes.across.z / normal.z), splat.acrossX, splat.acrossY);
      set(along - flat * (axes.along.z / normal.z), splat.alongX, splat.alongY);
    }
  }

  /// Sets the pixels that the splat may touch. False where it touches none of the picture.
  bool bound(const glm::vec3& centre, const glm::vec3& normal, FloodSplat& splat) const {
    const glm::vec3 reach = splat.radius * glm::sqrt(glm::max(1.0f - normal * normal, 0.0f));
    const float nearest = std::max(centre.z - reach.z, 0.2f * centre.z);
    glm::vec2 lo(kFar), hi(-kFar);
    for (const float z : {nearest, centre.z + reach.z})
      for (const float side : {-1.0f, 1.0f}) {
        const float scale = 1.0f / lens_.metres(z);
        const glm::vec2 pixel(lens_.middleX + (centre.x + side * reach.x) * scale,
                              lens_.middleY - (centre.y - side * reach.y) * scale);  // y points up
        lo = glm::min(lo, pixel);
        hi = glm::max(hi, pixel);
      }
    const auto within = [](float x, int least, int most) {
      return static_cast<std::int16_t>(std::clamp(x, static_cast<float>(least), static_cast<float>(most)));
    };
    splat.left = within(lo.x, 0, size_.x);
    splat.right = within(std::floor(hi.x), -1, size_.x - 1);
    splat.top = within(lo.y, 0, size_.y);
    splat.bottom = within(std::floor(hi.y), -1, size_.y - 1);
    return splat.left <= splat.right && splat.top <= splat.bottom;
  }

  const FloodSeeds& seeds_;
  const FloodLens& lens_;
  const glm::ivec2 size_;  ///< of the picture
  const FloodSettings& settings_;
};

/// Draws the splats of a strip of rows, in their order, so that sums of floats do not depend on the threads.
class StripPainter {
 public:
  StripPainter(const std::vector<FloodSplat>& splats, const FloodSettings& settings, const Picture& source)
      : splats_(splats),
        settings_(settings),
        source_(source),
        width_(static_cast<std::size_t>(source.width)),
        stride_(width_ + kFloodTile) {
    for (std::vector<float>* sums : {&limit_, &red_, &green_, &blue_, &depth_, &weight_, &heaviest_})
      sums->resize(stride_ * kStripRows);
    from_.resize(stride_ * kStripRows);
  }

  /// Draws splats into rows [top, bottom), and returns how many pixels it filled.
  std::uint64_t paint(const std::vector<std::uint32_t>& indices, int top, int bottom, Picture& picture) {
    std::fill(limit_.begin(), limit_.end(), kFar);
    for (std::vector<float>* sums : {&red_, &green_, &blue_, &depth_, &weight_, &heaviest_})
      std::fill(sums->begin(), sums->end(), 0.0f);
    const FloodStrip strip{top,          bottom,        stride_,        limit_.data(),    red_.data(), green_.data(),
                           blue_.data(), depth_.data(), weight_.data(), heaviest_.data(), from_.data()};
    for (const std::uint32_t i : indices) drawSplatDepth(splats_[i], strip);
    if (settings_.keepFront) closeFullPixels(top, bottom);
    for (const std::uint32_t i : indices) blendSplat(splats_[i], source_.colour[pixelOf(splats_[i].from)], strip);
    std::uint64_t filled = 0;
    for (int y = top; y < bottom; ++y) filled += write(y, top, picture);
    return filled;
  }

 private:
  std::size_t pixelOf(FloodPixel pixel) const {
    return static_cast<std::size_t>(pixelRow(pixel)) * width_ + static_cast<std::size_t>(pixelColumn(pixel));
  }

  /// Lets no splat count in pixels whose point lies in front of the limit.
  void closeFullPixels(int top, int bottom) {
    for (int y = top; y < bottom; ++y) {
      const float* depth = &source_.depth[static_cast<std::size_t>(y) * width_];
      float* limit = &limit_[static_cast<std::size_t>(y - top) * stride_];
      for (std::size_t x = 0; x < width_; ++x) limit[x] = depth[x] > limit[x] ? limit[x] : -1.0f;
    }
  }

  std::uint64_t write(int y, int top, Picture& picture) const {
    std::uint64_t filled = 0;
    const std::size_t row = static_cast<std::size_t>(y) * width_, first = static_cast<std::size_t>(y - top) * stride_;
    for (std::size_t x = 0; x < width_; ++x) {
      const std::size_t i = first + x;
      if (!(weight_[i] > 0.0f)) continue;
      const float share = 1.0f / weight_[i];
      const auto mean = [share](float sum) { return static_cast<std::uint32_t>(sum * share + 0.5f); };
      picture.colour[row + x] = mean(red_[i]) | mean(green_[i]) << 8 | mean(blue_[i]) << 16 | 0xff000000u;
      picture.depth[row + x] = depth_[i] * share;
      picture.pointId[row + x] = source_.pointId[pixelOf(from_[i])];
      ++filled;
    }
    return filled;
  }

  const std::vector<FloodSplat>& splats_;
  const FloodSettings& settings_;
  const Picture& source_;  ///< before filling
  const std::size_t width_, stride_;
  std::vector<float> limit_, red_, green_, blue_, depth_, weight_, heaviest_;
  std::vector<FloodPixel> from_;
};

}  // namespace

std::vector<FloodSplat> makeSplats(const FloodSeeds& seeds, const std::vector<FloodNeighbours>& neighbours,
                                   const glm::ivec2& size, const FloodSettings& settings, const ThreadPool& pool) {
  const SplatMaker maker(seeds, size, settings);
  const auto columns = static_cast<std::size_t>(seeds.width), rows = static_cast<std::size_t>(seeds.height);
  const std::size_t strips = (rows + kRowsAtOnce - 1) / kRowsAtOnce;
  std::vector<std::vector<FloodSplat>> made(strips);
  pool.parallelFor(strips, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t strip = begin; strip < end; ++strip) {
      const std::size_t first = strip * kRowsAtOnce * columns;
      for (std::size_t i = first; i < std::min(first + kRowsAtOnce * columns, rows * columns); ++i) {
        FloodSplat splat;
        if (seeds.at[i] != kNoPixel && maker.make(seeds.at[i], neighbours[i], splat)) made[strip].push_back(splat);
      }
    }
  });
  std::vector<FloodSplat> splats;
  for (const auto& strip : made) splats.insert(splats.end(), strip.begin(), strip.end());
  return splats;
}

std::uint64_t drawSplats(const std::vector<FloodSplat>& splats, const FloodSettings& settings, const ThreadPool& pool,
                         Picture& picture) {
  if (splats.empty()) return 0;
  const auto strips = static_cast<std::size_t>((picture.height + kStripRows - 1) / kStripRows);
  std::vector<std::vector<std::uint32_t>> inStrip(strips);
  for (std::uint32_t i = 0; i < splats.size(); ++i)
    for (int strip = splats[i].top / kStripRows; strip * kStripRows <= splats[i].bottom; ++strip)
      inStrip[static_cast<std::size_t>(strip)].push_back(i);
  std::atomic<std::uint64_t> filled{0};
  const Picture source = picture;
  pool.parallelFor(strips, std::max<std::size_t>(strips / (4 * static_cast<std::size_t>(pool.threads())), 1),
                   [&](std::size_t begin, std::size_t end) {
                     StripPainter painter(splats, settings, source);
                     for (std::size_t strip = begin; strip < end; ++strip) {
                       const int top = static_cast<int>(strip) * kStripRows;
                       filled +=
                           painter.paint(inStrip[strip], top, std::min(top + kStripRows, picture.height), picture);
                     }
                   });
  return filled;
}

}  // namespace strata
