#include "io/synthetic/scanner.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "io/synthetic/random.h"

namespace strata::synthetic {
namespace {

constexpr int kTries = 24;  // rays into the sky before the point is taken straight below the scanner
constexpr float kTurn = 2.0f * std::numbers::pi_v<float>;

/// Azimuths between which the box lies, and whether the station stands above or within it.
struct AzimuthRange {
  float middle, half;
};

AzimuthRange azimuthsOf(const glm::vec2& low, const glm::vec2& high) {
  const glm::vec2 centre = (low + high) * 0.5f;
  const float middle = std::atan2(centre.y, centre.x);
  float half = 0.0f;
  for (const glm::vec2& corner : {low, high, glm::vec2(low.x, high.y), glm::vec2(high.x, low.y)}) {
    const float turn = std::remainder(std::atan2(corner.y, corner.x) - middle, kTurn);
    half = std::max(half, std::abs(turn));
  }
  return {middle, half};
}

}  // namespace

ScannerScan::ScannerScan(ScannedScene scanned, std::uint64_t points, std::uint64_t seed)
    : scene_(std::move(scanned.scene)),
      ground_(scanned.ground),
      lighting_(std::move(scanned.lighting)),
      stations_(std::move(scanned.stations)),
      extent_(scanned.extent),
      key_(mix64(seed ^ 0x5ca11e5)) {
  double total = 0.0;
  for (const Station& station : stations_) {
    horizons_.push_back(horizonOf(station));
    total += static_cast<double>(station.weight) * static_cast<double>(horizons_.back().area);
  }
  double sum = 0.0;
  firstPoint_.push_back(0);
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    sum += static_cast<double>(stations_[i].weight) * static_cast<double>(horizons_[i].area);
    const auto end = static_cast<std::uint64_t>(sum / total * static_cast<double>(points));
    firstPoint_.push_back(std::clamp(end, firstPoint_.back(), points));
  }
  firstPoint_.back() = points;
}

ScannerScan::Horizon ScannerScan::horizonOf(const Station& station) const {
  const glm::vec2 eye(station.position.x, station.position.y);
  // Ground at the end of the reach is the lowest horizon there can be.
  const float ground = std::max(station.lowest, -std::asin(std::min(1.0f, station.position.z / station.reach)));
  std::vector<float> highest(Horizon::kBins, std::min(ground, station.highest));
  for (const Primitive& p : scene_.primitives()) {
    const glm::vec2 low = glm::vec2(p.min.x, p.min.y) - eye, high = glm::vec2(p.max.x, p.max.y) - eye;
    const float nearest = glm::length(glm::clamp(glm::vec2(0.0f), low, high));
    if (nearest > station.reach) continue;
    const float up = p.max.z - station.position.z;
    const float distance = up > 0.0f ? nearest : glm::length(glm::max(glm::abs(low), glm::abs(high)));
    const float elevation = std::min(std::atan2(up, std::max(distance, 0.01f)), station.highest);
    const AzimuthRange range = nearest < 0.01f ? AzimuthRange{0.0f, kTurn} : azimuthsOf(low, high);
    const float perBin = static_cast<float>(Horizon::kBins) / kTurn;
    const int from = static_cast<int>(std::floor((range.middle - range.half) * perBin));
    const int to =
        std::min(from + Horizon::kBins - 1, static_cast<int>(std::floor((range.middle + range.half) * perBin)));
    for (int bin = from; bin <= to; ++bin) {
      float& entry = highest[static_cast<std::size_t>((bin + 2 * Horizon::kBins) % Horizon::kBins)];
      entry = std::max(entry, elevation);
    }
  }
  Horizon horizon;
  horizon.lowest = station.solidAngle ? std::sin(station.lowest) : station.lowest;
  horizon.cumulative.push_back(0.0f);
  for (float& entry : highest) {
    if (station.solidAngle) entry = std::sin(entry);
    horizon.area += (entry - horizon.lowest) / static_cast<float>(Horizon::kBins);
    horizon.cumulative.push_back(horizon.area);
  }
  for (float& entry : horizon.cumulative) entry /= horizon.area;
  horizon.highest = std::move(highest);
  return horizon;
}

glm::vec3 ScannerScan::direction(const Station& station, const Horizon& horizon, float u, float v) const {
  const auto after = std::upper_bound(horizon.cumulative.begin() + 1, horizon.cumulative.end() - 1, u);
  const auto bin = static_cast<std::size_t>(after - horizon.cumulative.begin()) - 1;
  const float low = horizon.cumulative[bin], width = horizon.cumulative[bin + 1] - low;
  const float within = width > 0.0f ? std::clamp((u - low) / width, 0.0f, 1.0f) : 0.0f;
  const float azimuth = (static_cast<float>(bin) + within) * (kTurn / static_cast<float>(Horizon::kBins));
  const float height = horizon.lowest + (horizon.highest[bin] - horizon.lowest) * v;
  const float z = station.solidAngle ? height : std::sin(height);
  const float level = std::sqrt(std::max(0.0f, 1.0f - z * z));
  return {level * std::cos(azimuth), level * std::sin(azimuth), z};
}

std::size_t ScannerScan::stationOf(std::uint64_t point) const {
  const auto after = std::upper_bound(firstPoint_.begin() + 1, firstPoint_.end() - 1, point);
  return static_cast<std::size_t>(after - firstPoint_.begin()) - 1;
}

void ScannerScan::generate(std::uint64_t first, std::span<ShapePoint> out) const {
  std::size_t station = stationOf(first);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::uint64_t point = first + i;
    while (station + 1 < stations_.size() && point >= firstPoint_[station + 1]) ++station;
    const std::uint64_t count = firstPoint_[station + 1] - firstPoint_[station];
    const double sweep = static_cast<double>(point - firstPoint_[station]) / static_cast<double>(count);
    measure(station, sweep, point, out[i]);
  }
}

void ScannerScan::measure(std::size_t station, double sweep, std::uint64_t point, ShapePoint& out) const {
  const Station& from = stations_[station];
  CounterRandom random(key_, point);
  const std::uint64_t raySeed = random.bits();
  Hit hit;
  Ray ray(from.position, {0.0f, 0.0f, -1.0f}, raySeed);
  bool found = false;
  for (int attempt = 0; attempt < kTries && !found; ++attempt) {
    const float u = attempt == 0 ? static_cast<float>(sweep) : random.uniformFloat();
    ray = Ray(from.position, direction(from, horizons_[station], u, random.uniformFloat()),
              raySeed + static_cast<std::uint64_t>(attempt));
    found = scene_.trace(ray, from.reach, hit);
  }
  if (!found) {
    ray = Ray(from.position, {0.0f, 0.0f, -1.0f}, raySeed);
    scene_.trace(ray, from.reach, hit);
  }
  glm::vec3 normal;
  const Surface surface = surfaceOf(ray, hit, normal);
  const glm::vec3 at = ray.origin + ray.direction * hit.t;
  const float facing = std::abs(glm::dot(normal, ray.direction));
  const float range = hit.t + kNoiseM * random.bell();
  out.position = glm::dvec3(ray.origin) + glm::dvec3(ray.direction) * static_cast<double>(range);
  out.normal = normal;
  const glm::vec3 lit = surface.albedo * glm::mix(light(at, normal, raySeed), glm::vec3(1.0f), surface.glow);
  out.colour = lit + 0.008f * random.bell();  // the camera's noise
  const float spread = 1.0f / (1.0f + hit.t * hit.t * (1.0f / 3600.0f));
  out.intensity = surface.reflectance * (0.35f + 0.65f * facing) * (0.4f + 0.6f * spread) + 0.01f * random.bell();
  out.classification = surface.classification;
}

Surface ScannerScan::surfaceOf(const Ray& ray, Hit& hit, glm::vec3& normal) const {
  const glm::vec3 at = ray.origin + ray.direction * hit.t;
  normal = hit.normal;
  if (hit.primitive == Hit::kGround) return plainSurface({ground_, 0, at, at, glm::vec3(1.0f), normal});
  const Primitive& p = scene_.primitives()[static_cast<std::size_t>(hit.primitive)];
  const SurfacePoint point{p.material, p.seed, at, at - p.min, p.max - p.min, normal};
  if (p.kind != PrimitiveKind::box || !hasWindows(p.material)) return plainSurface(point);
  const FacadeHit facade = hitFacade(point, p.windowSides, ray.direction);
  hit.t += facade.deeper;
  normal = facade.normal;
  return facade.surface;
}

glm::vec3 ScannerScan::light(const glm::vec3& position, const glm::vec3& normal, std::uint64_t raySeed) const {
  const glm::vec3 start = position + normal * 0.03f;
  if (!lighting_.indoor) {
    const float nearGround = normal.z < 0.5f ? 0.72f + 0.28f * std::min(position.z / 2.5f, 1.0f) : 1.0f;
    const glm::vec3 sky = glm::vec3(0.50f, 0.53f, 0.60f) * (0.74f + 0.26f * normal.z) * nearGround;
    const float facing = glm::dot(normal, lighting_.sun);
    if (facing <= 0.0f || scene_.blocked(Ray(start, lighting_.sun, raySeed), 200.0f)) return sky;
    return sky + glm::vec3(0.80f, 0.74f, 0.62f) * facing;
  }
  const glm::vec3 shifted = position + normal * 0.3f;  // away from the wall, to find a lamp of this room
  const float lampX = (std::floor(shifted.x / lighting_.lampPitch) + 0.5f) * lighting_.lampPitch;
  const auto row = std::min_element(lighting_.lampRows.begin(), lighting_.lampRows.end(), [&](float a, float b) {
    return std::abs(a - shifted.y) < std::abs(b - shifted.y);
  });
  CounterRandom random(raySeed, 1);
  const glm::vec3 lamp(lampX + random.between(-0.5f, 0.5f), *row + random.between(-0.15f, 0.15f), lighting_.lampHeight);
  const glm::vec3 way = lamp - start;
  const float distance = glm::length(way), facing = std::max(0.0f, glm::dot(normal, way) / distance);
  const float corner = 0.8f + 0.2f * std::min(position.z / 0.6f, 1.0f);
  const glm::vec3 ambient =
      glm::vec3(0.60f, 0.59f, 0.57f) * (normal.z < -0.5f ? 1.35f : 0.9f + 0.1f * normal.z) * corner;
  if (facing <= 0.0f || scene_.blocked(Ray(start, way / distance, raySeed), distance - 0.1f)) return ambient;
  return ambient + glm::vec3(0.66f, 0.62f, 0.55f) * (facing / (0.8f + 0.14f * distance * distance));
}

}  // namespace strata::synthetic
