#include <algorithm>
#include <cmath>

#include "io/synthetic/random.h"
#include "io/synthetic/shape.h"

namespace strata::synthetic {
namespace {

constexpr double kLargestSideM = 8000.0, kSmallestSideM = 100.0;
constexpr double kStripM = 420.0;  // distance of the flight lines
constexpr double kOverlap = 0.3;   // share of a strip that its neighbour covers too
constexpr double kFlyingHeightM = 1100.0;
constexpr float kReliefM = 260.0f;    // from the lake to the highest summit
constexpr float kWaterLevel = 0.27f;  // share of the relief
constexpr float kTreeM = 24.0f;
constexpr int kOctaves = 8;

/// Height as a share of the relief, and its slope in metres per metre.
struct Ground {
  float height, slopeX, slopeY;
};

class TerrainShape final : public Shape {
 public:
  TerrainShape(std::uint64_t points, std::uint64_t seed)
      : side_(std::clamp(std::sqrt(static_cast<double>(points)), kSmallestSideM, kLargestSideM)),
        strips_(std::max<std::uint64_t>(1, static_cast<std::uint64_t>(side_ / kStripM))),
        points_(points),
        key_(mix64(seed ^ 0x7e44a1)),
        noiseSeed_(static_cast<std::uint32_t>(key_)) {
    spacing_ = side_ / (static_cast<double>(strips_) + kOverlap);
    extent_.origin = {500000.0, 5400000.0, 400.0};
    extent_.max = {side_, side_, static_cast<double>(kReliefM + kTreeM)};
  }
  const ShapeExtent& extent() const override { return extent_; }
  void generate(std::uint64_t first, std::span<ShapePoint> out) const override {
    for (ShapePoint& point : out) measure(first++, point);
  }

 private:
  /// Fractal noise whose finer octaves fade on steep ground, which leaves ridges sharp and valleys smooth (the
  /// derivative trick of Quilez 2008).
  Ground groundAt(double x, double y) const {
    float height = 0.0f, dx = 0.0f, dy = 0.0f, amplitude = 0.5f, frequency = 1.0f / 620.0f;
    for (int octave = 0; octave < kOctaves; ++octave) {
      const NoiseValue n = valueNoise(static_cast<float>(x) * frequency, static_cast<float>(y) * frequency,
                                      noiseSeed_ + static_cast<std::uint32_t>(octave));
      dx += n.dx * frequency * amplitude * kReliefM;
      dy += n.dy * frequency * amplitude * kReliefM;
      height += amplitude * n.value / (1.0f + 0.5f * (dx * dx + dy * dy));
      amplitude *= 0.5f;
      frequency *= 2.03f;
    }
    constexpr float kContrast = 1.8f, kLow = 0.27f;  // spreads what the sum of octaves crowds around its mean
    return {std::clamp((height - kLow) * kContrast, 0.0f, 1.0f), dx * kContrast, dy * kContrast};
  }

  /// Woods thin out upwards and on steep ground; each tree is a cone on a jittered grid of 5 m.
  float treeAt(double x, double y, const Ground& ground, float slope) const {
    const float wood =
        valueNoise(static_cast<float>(x) / 130.0f, static_cast<float>(y) / 130.0f, noiseSeed_ + 50).value;
    const float glade = valueNoise(static_cast<float>(x) / 31.0f, static_cast<float>(y) / 31.0f, noiseSeed_ + 51).value;
    if (wood + 0.4f * glade < 0.72f || ground.height < kWaterLevel + 0.03f || ground.height > 0.66f || slope > 0.9f)
      return 0.0f;
    const double cellX = std::floor(x / 5.0), cellY = std::floor(y / 5.0);
    const int ix = static_cast<int>(cellX), iy = static_cast<int>(cellY);
    const double offX = x - (cellX + 0.35 + 0.3 * static_cast<double>(cellHash(ix, iy, noiseSeed_))) * 5.0;
    const double offY = y - (cellY + 0.35 + 0.3 * static_cast<double>(cellHash(iy, ix, noiseSeed_ + 1))) * 5.0;
    const float height = (0.4f + 0.6f * cellHash(ix, iy, noiseSeed_ + 2)) * kTreeM;
    return std::max(0.0f, height * (1.0f - static_cast<float>(std::hypot(offX, offY)) / 2.4f));
  }

  void measure(std::uint64_t index, ShapePoint& point) const {
    CounterRandom random(key_, index);
    const auto strip =
        std::min(strips_ - 1, static_cast<std::uint64_t>(static_cast<double>(index) / static_cast<double>(points_) *
                                                         static_cast<double>(strips_)));
    const double flown = static_cast<double>(index) * static_cast<double>(strips_) / static_cast<double>(points_) -
                         static_cast<double>(strip);
    const double halfWidth = spacing_ * (1.0 + kOverlap) * 0.5,
                 centre = spacing_ * static_cast<double>(strip) + halfWidth;
    const double angle =
        (2.0 * random.uniform() - 1.0) * std::atan(halfWidth / kFlyingHeightM);  // an even turning mirror
    const double x = std::clamp(strip % 2 == 0 ? flown : 1.0 - flown, 0.0, 1.0) * side_;
    const double y = centre + kFlyingHeightM * std::tan(angle);
    Ground ground = groundAt(x, y);
    const float slope = std::hypot(ground.slopeX, ground.slopeY);
    glm::vec3 colour;
    float tree = 0.0f, reflectance = 0.5f;
    point.classification = asprs::kGround;
    if (ground.height < kWaterLevel) {
      colour = glm::mix(glm::vec3(0.08f, 0.24f, 0.36f), glm::vec3(0.26f, 0.52f, 0.58f), ground.height / kWaterLevel);
      ground = {kWaterLevel, 0.0f, 0.0f};
      point.classification = asprs::kWater;
      reflectance = 0.08f;
    } else {
      tree = treeAt(x, y, ground, slope);
      const float grain = valueNoise(static_cast<float>(x) * 0.3f, static_cast<float>(y) * 0.3f, noiseSeed_ + 60).value;
      const glm::vec3 meadow = glm::mix(glm::vec3(0.34f, 0.46f, 0.20f), glm::vec3(0.56f, 0.55f, 0.30f), grain);
      const glm::vec3 rock = glm::mix(glm::vec3(0.42f, 0.39f, 0.36f), glm::vec3(0.56f, 0.53f, 0.49f), grain);
      colour = glm::mix(meadow, rock, std::clamp((slope - 0.55f) * 3.0f + (ground.height - 0.62f) * 4.0f, 0.0f, 1.0f));
      if (ground.height < kWaterLevel + 0.012f) colour = {0.74f, 0.68f, 0.52f};
      colour = glm::mix(colour, glm::vec3(0.95f, 0.96f, 0.98f),
                        std::clamp((ground.height - 0.72f - 0.08f * grain) * 14.0f - slope, 0.0f, 1.0f));
      if (tree > 0.5f && random.chance(0.8f)) {  // the rest of the pulses reach the ground
        colour = glm::vec3(0.16f, 0.30f, 0.12f) * (0.6f + 1.0f * tree / kTreeM + 0.3f * random.uniformFloat());
        point.classification = asprs::kHighVegetation;
        reflectance = 0.7f;
      } else {
        tree = 0.0f;
      }
    }
    point.normal = glm::normalize(glm::vec3(-ground.slopeX, -ground.slopeY, 1.0f));
    const float sun = std::max(0.0f, glm::dot(point.normal, glm::vec3(-0.55f, 0.35f, 0.76f)));
    point.colour = colour * (0.42f + 0.78f * (tree > 0.0f ? 0.75f : sun));
    point.intensity = reflectance * point.normal.z + 0.02f * random.bell();
    point.position = {x, y,
                      static_cast<double>(ground.height * kReliefM + tree) + 0.03 * static_cast<double>(random.bell())};
  }

  double side_, spacing_ = 0.0;
  std::uint64_t strips_, points_, key_;
  std::uint32_t noiseSeed_;
  ShapeExtent extent_;
};

}  // namespace

std::unique_ptr<Shape> makeTerrain(std::uint64_t points, std::uint64_t seed) {
  return std::make_unique<TerrainShape>(points, seed);
}

}  // namespace strata::synthetic
