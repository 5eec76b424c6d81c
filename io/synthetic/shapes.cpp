#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "io/synthetic/random.h"
#include "io/synthetic/shape.h"

namespace strata::synthetic {
namespace {

/// A colour wheel; `hue` from 0 to 1.
glm::vec3 rainbow(float hue) {
  const auto channel = [&](float shift) {
    return std::clamp(std::abs(std::fmod(hue + shift, 1.0f) * 6.0f - 3.0f) - 1.0f, 0.0f, 1.0f);
  };
  return glm::vec3(channel(0.0f), channel(2.0f / 3.0f), channel(1.0f / 3.0f)) * 0.8f + 0.1f;
}

class PlaneShape final : public Shape {
 public:
  explicit PlaneShape(std::uint64_t seed) : key_(mix64(seed ^ 0x91a2e)) { extent_.max = {kSide, kSide, 0.0}; }
  const ShapeExtent& extent() const override { return extent_; }
  void generate(std::uint64_t first, std::span<ShapePoint> out) const override {
    for (ShapePoint& point : out) {
      CounterRandom random(key_, first++);
      point.position = {random.uniform() * kSide, random.uniform() * kSide, 0.0};
      const auto tile = static_cast<int>(point.position.x * 0.1) + static_cast<int>(point.position.y * 0.1);
      point.colour = glm::vec3(static_cast<float>(point.position.x / kSide),
                               static_cast<float>(point.position.y / kSide), tile % 2 == 0 ? 0.3f : 0.7f);
      point.intensity = random.uniformFloat();
      point.classification = asprs::kGround;
    }
  }

 private:
  static constexpr double kSide = 100.0;
  ShapeExtent extent_;
  std::uint64_t key_;
};

/// Günther et al. 2013, section 4: a cuboid of n planes with 1024 x 1024 points each, in random order; a camera that
/// looks along y sees n points behind one another everywhere. n is that paper's largest, 170, and the planes are
/// parallel to xz and `kSpacingM` apart, as are the points in them. The paper's cuboid is the one of 170 * 1024^2 = 178
/// 257 920 points; other counts change the planes' width and height and keep the 170 layers.
class StackShape final : public Shape {
 public:
  StackShape(std::uint64_t points, std::uint64_t seed)
      : points_(points), layers_(std::min<std::uint64_t>(points, kLayers)), key_(mix64(seed ^ 0x57ac4)) {
    const std::uint64_t perLayer = (points + layers_ - 1) / layers_;
    side_ = static_cast<std::uint64_t>(std::ceil(std::sqrt(static_cast<double>(perLayer))));
    halfBits_ = std::max(1, (static_cast<int>(std::bit_width(points - 1)) + 1) / 2);
    extent_.max =
        glm::dvec3(static_cast<double>(side_ - 1), static_cast<double>(layers_ - 1), static_cast<double>(side_ - 1)) *
        kSpacingM;
  }
  const ShapeExtent& extent() const override { return extent_; }
  void generate(std::uint64_t first, std::span<ShapePoint> out) const override {
    for (ShapePoint& point : out) {
      const std::uint64_t place = shuffled(first++), layer = place % layers_, cell = place / layers_;
      const std::uint64_t x = cell % side_, z = cell / side_;
      point.position =
          glm::dvec3(static_cast<double>(x), static_cast<double>(layer), static_cast<double>(z)) * kSpacingM;
      const bool dark = ((x * 16 / side_) + (z * 16 / side_)) % 2 == 0;
      point.colour = rainbow(static_cast<float>(layer) / static_cast<float>(layers_)) * (dark ? 0.75f : 1.0f);
      point.intensity = static_cast<float>(layer) / static_cast<float>(layers_);
      point.normal = {0.0f, -1.0f, 0.0f};
    }
  }

 private:
  static constexpr std::uint64_t kLayers = 170;
  static constexpr double kSpacingM = 0.01;

  /// A permutation of [0, points): four Feistel rounds over the next power of four, repeated until the result is
  /// inside.
  std::uint64_t shuffled(std::uint64_t index) const {
    const std::uint64_t mask = (std::uint64_t{1} << halfBits_) - 1;
    do {
      std::uint64_t left = index >> halfBits_, right = index & mask;
      for (std::uint64_t round = 0; round < 4; ++round) {
        const std::uint64_t next = left ^ (mix64(right + key_ + round * 0x9e3779b97f4a7c15ULL) & mask);
        left = right;
        right = next;
      }
      index = left << halfBits_ | right;
    } while (index >= points_);
    return index;
  }

  ShapeExtent extent_;
  std::uint64_t points_, layers_, side_ = 1, key_;
  int halfBits_ = 1;
};

class SphereShape final : public Shape {
 public:
  explicit SphereShape(std::uint64_t seed) : key_(mix64(seed ^ 0x5be3e)) {
    extent_.min = glm::dvec3(-kRadius);
    extent_.max = glm::dvec3(kRadius);
    extent_.hasNormals = true;
  }
  const ShapeExtent& extent() const override { return extent_; }
  void generate(std::uint64_t first, std::span<ShapePoint> out) const override {
    for (ShapePoint& point : out) {
      CounterRandom random(key_, first++);
      const double z = 2.0 * random.uniform() - 1.0, turn = 2.0 * std::numbers::pi * random.uniform();
      const double level = std::sqrt(1.0 - z * z);  // Archimedes: equal slices have equal area
      const glm::dvec3 normal(level * std::cos(turn), level * std::sin(turn), z);
      point.position = normal * kRadius;
      point.normal = glm::vec3(normal);
      point.colour = point.normal * 0.5f + 0.5f;
      point.intensity = point.colour.z;
    }
  }

 private:
  static constexpr double kRadius = 10.0;
  ShapeExtent extent_;
  std::uint64_t key_;
};

/// Points that break converters. Their index modulo 10 decides: 0 and 1 are copies of one point, 2 and 3 lie on a line,
/// 4 and 5 on a plane, 6 to 8 in a cube of 1 cm, and 9 anywhere within 100 m. Of 1000 points or more, ten lie up to
/// 2000 km away.
class DegenerateShape final : public Shape {
 public:
  DegenerateShape(std::uint64_t points, std::uint64_t seed)
      : key_(mix64(seed ^ 0xde6e)), outlierStep_(points >= 1000 ? points / kOutliers : 0) {
    extent_.min = outlierStep_ > 0 ? glm::dvec3(-kFar) : glm::dvec3(0.0);
    extent_.max = outlierStep_ > 0 ? glm::dvec3(kFar) : glm::dvec3(kSide);
  }
  const ShapeExtent& extent() const override { return extent_; }
  void generate(std::uint64_t first, std::span<ShapePoint> out) const override {
    for (ShapePoint& point : out) {
      const std::uint64_t index = first++;
      CounterRandom random(key_, index);
      const glm::dvec3 uniform(random.uniform(), random.uniform(), random.uniform());
      const auto kind = static_cast<std::size_t>(index % 10);
      point.position = place(kind, uniform);
      if (outlierStep_ > 0 && index % outlierStep_ == outlierStep_ / 2 && index / outlierStep_ < kOutliers) {
        point.position = (uniform * 2.0 - 1.0) * kFar;
        point.position[static_cast<int>(index % 3)] = kFar;
      }
      point.colour = rainbow(static_cast<float>(kind) * 0.1f);
      point.intensity = static_cast<float>(kind) * 0.1f;
    }
  }

 private:
  static constexpr double kSide = 100.0, kFar = 2.0e6;
  static constexpr std::uint64_t kOutliers = 10;

  static glm::dvec3 place(std::size_t kind, const glm::dvec3& uniform) {
    if (kind < 2) return {12.345, 67.891, 23.456};
    if (kind < 4) return glm::dvec3(10.0, 20.0, 30.0) + glm::dvec3(60.0, 45.0, 20.0) * uniform.x;
    if (kind < 6) return {uniform.x * kSide, uniform.y * kSide, 50.0};
    if (kind < 9) return glm::dvec3(70.0, 30.0, 10.0) + uniform * 0.01;
    return uniform * kSide;
  }

  ShapeExtent extent_;
  std::uint64_t key_, outlierStep_;
};

}  // namespace

std::unique_ptr<Shape> makePlane(std::uint64_t, std::uint64_t seed) { return std::make_unique<PlaneShape>(seed); }
std::unique_ptr<Shape> makeStack(std::uint64_t points, std::uint64_t seed) {
  return std::make_unique<StackShape>(points, seed);
}
std::unique_ptr<Shape> makeSphere(std::uint64_t, std::uint64_t seed) { return std::make_unique<SphereShape>(seed); }
std::unique_ptr<Shape> makeDegenerate(std::uint64_t points, std::uint64_t seed) {
  return std::make_unique<DegenerateShape>(points, seed);
}

}  // namespace strata::synthetic
