#include "io/synthetic/scenes.h"

#include <algorithm>
#include <cmath>

#include "io/synthetic/scanner.h"
#include "io/synthetic/scene_builder.h"
#include "io/synthetic/street_grid.h"

namespace strata::synthetic {
namespace {

using namespace city;

constexpr float kCellM = 6.0f;  // columns of the scene's grid
constexpr float kTripodM = 1.9f;
constexpr float kDroneM = 85.0f;
constexpr glm::dvec3 kOrigin(500000.0, 5400000.0, 250.0);

/// One more row of blocks for ten times the points.
int blocksFor(std::uint64_t points) {
  int blocks = 3;
  for (std::uint64_t limit = 3'000'000; points > limit && blocks < 6; limit *= 10) ++blocks;
  return blocks;
}

void addPark(SceneBuilder& b, const glm::vec2& min, const glm::vec2& max) {
  b.box({min.x, min.y, 0.0f}, {max.x, max.y, kKerb + 0.06f}, Material::grass);
  const glm::vec2 middle = (min + max) * 0.5f;
  b.box({min.x, middle.y - 1.5f, 0.0f}, {max.x, middle.y + 1.5f, kKerb + 0.08f}, Material::gravel);
  b.box({middle.x - 1.5f, min.y, 0.0f}, {middle.x + 1.5f, max.y, kKerb + 0.08f}, Material::gravel);
  b.cone({middle.x, middle.y, 0.0f}, {9.5f, kKerb + 0.09f, 1.0f}, Material::gravel);
  b.cone({middle.x, middle.y, 0.0f}, {7.0f, kKerb + 0.14f, 1.0f}, Material::sandstone);
  b.cone({middle.x, middle.y, 0.0f}, {6.6f, kKerb + 0.16f, 1.0f}, Material::water);
  for (const float sign : {-1.0f, 1.0f}) {
    addBench(b, {middle.x + sign * 12.0f, middle.y + 2.2f, kKerb + 0.06f}, true);
    addBench(b, {middle.x - 2.4f, middle.y + sign * 12.0f, kKerb + 0.06f}, false);
  }
  for (int i = 0; i < 30; ++i) {
    const glm::vec2 at = glm::mix(min + 3.0f, max - 3.0f, glm::vec2(b.random.uniformFloat(), b.random.uniformFloat()));
    const glm::vec2 off = glm::abs(at - middle);
    if (std::min(off.x, off.y) < 3.5f || glm::length(off) < 13.0f) continue;
    if (b.random.chance(0.25f))
      addConifer(b, {at.x, at.y, kKerb}, b.random.between(7.0f, 14.0f));
    else
      addTree(b, {at.x, at.y, kKerb}, b.random.between(6.0f, 13.0f));
  }
}

/// The square with the church, a fountain and a market; `min` and `max` bound the paved block.
void addSquare(SceneBuilder& b, const glm::vec2& min, const glm::vec2& max) {
  const glm::vec2 middle = (min + max) * 0.5f;
  addChurch(b, {middle.x + 8.0f, middle.y + 13.0f, kKerb});
  addFountain(b, {middle.x - 13.0f, middle.y - 14.0f, kKerb});
  for (int i = 0; i < 6; ++i)
    addStall(b, {middle.x + 2.0f + 4.6f * static_cast<float>(i % 3) * 1.2f,
                 middle.y - 12.0f - 6.0f * static_cast<float>(i / 3), kKerb});
  for (int i = 0; i < 5; ++i) {
    addTree(b, {min.x + 4.0f, min.y + 7.0f + 12.0f * static_cast<float>(i), kKerb}, b.random.between(7.0f, 9.0f));
    addTree(b, {min.x + 8.0f + 12.0f * static_cast<float>(i), min.y + 3.5f, kKerb}, b.random.between(7.0f, 9.0f));
  }
  for (int i = 0; i < 3; ++i)
    addBench(b, {middle.x - 22.0f + 7.0f * static_cast<float>(i), middle.y - 21.5f, kKerb}, true);
}

/// Lamps, trees and parked cars along the four sides of a block.
void addKerbside(SceneBuilder& b, const glm::vec2& min, const glm::vec2& max) {
  for (const float offset : {10.0f, 31.5f, 53.0f}) {
    addLamp(b, {min.x + offset, min.y + 0.5f, kKerb}, {0.0f, -1.0f});
    addLamp(b, {max.x - 0.5f, min.y + offset, kKerb}, {1.0f, 0.0f});
  }
  for (const float offset : {5.0f, 16.0f, 24.0f, 39.0f, 47.0f, 58.0f}) {
    if (b.random.chance(0.75f)) addTree(b, {min.x + offset, max.y - 0.9f, kKerb}, b.random.between(5.5f, 8.0f));
    if (b.random.chance(0.75f)) addTree(b, {min.x + 0.9f, min.y + offset, kKerb}, b.random.between(5.5f, 8.0f));
  }
  for (float offset = 9.5f; offset < max.x - min.x - 8.0f; offset += 5.5f) {
    if (b.random.chance(0.45f)) addCar(b, {min.x + offset, min.y - 1.05f, 0.0f}, true);
    if (b.random.chance(0.45f)) addCar(b, {min.x + offset, max.y + 1.05f, 0.0f}, true);
    if (b.random.chance(0.45f)) addCar(b, {min.x - 1.05f, min.y + offset, 0.0f}, false);
    if (b.random.chance(0.45f)) addCar(b, {max.x + 1.05f, min.y + offset, 0.0f}, false);
  }
}

void addBlock(SceneBuilder& b, int column, int row, int blocks) {
  const glm::vec2 corner(static_cast<float>(column) * kPitch, static_cast<float>(row) * kPitch);
  const glm::vec2 min = corner + kCarriageway * 0.5f, max = corner + kPitch - kCarriageway * 0.5f;
  b.box({min.x, min.y, -0.1f}, {max.x, max.y, kKerb}, Material::pavement);
  addKerbside(b, min, max);
  const glm::vec2 low = min + kPavement, high = max - kPavement;
  const int centre = blocks / 2;
  if (column == centre && row == centre) return addSquare(b, low, high);
  if (column == centre - 1 && row == centre - 1) return addPark(b, low, high);
  if (column == centre + 1 && row == centre) return addTowers(b, low, high);
  const float kind = b.random.uniformFloat();
  if (kind < 0.62f)
    addPerimeterBlock(b, low, high);
  else if (kind < 0.84f)
    addVillas(b, low, high);
  else if (kind < 0.92f)
    addPark(b, low, high);
  else
    addTowers(b, low, high);
}

/// Meadows with trees around the blocks; the streets run on between them.
void addOutskirts(SceneBuilder& b, int blocks) {
  const float half = kCarriageway * 0.5f, end = static_cast<float>(blocks) * kPitch;
  const auto low = [&](int i) { return i < 0 ? -kOutskirts : static_cast<float>(i) * kPitch + half; };
  const auto high = [&](int i) { return i >= blocks ? end + kOutskirts : static_cast<float>(i + 1) * kPitch - half; };
  for (int y = -1; y <= blocks; ++y) {
    for (int x = -1; x <= blocks; ++x) {
      if (x >= 0 && y >= 0 && x < blocks && y < blocks) continue;
      const glm::vec2 min(low(x), low(y)), max(high(x), high(y));
      b.box({min.x, min.y, -0.1f}, {max.x, max.y, 0.08f}, Material::grass);
      for (int i = 0; i < 7; ++i) {
        const glm::vec2 at =
            glm::mix(min + 4.0f, max - 4.0f, glm::vec2(b.random.uniformFloat(), b.random.uniformFloat()));
        if (b.random.chance(0.35f))
          addConifer(b, {at.x, at.y, 0.08f}, b.random.between(6.0f, 15.0f));
        else
          addTree(b, {at.x, at.y, 0.08f}, b.random.between(5.0f, 12.0f));
      }
    }
  }
}

std::vector<Station> stationsFor(const Scene& scene, int blocks) {
  std::vector<Station> stations;
  for (int y = 0; y <= blocks; ++y) {
    for (int x = 0; x <= blocks; ++x) {
      Station tripod;
      tripod.position = {static_cast<float>(x) * kPitch, static_cast<float>(y) * kPitch, kTripodM};
      if (scene.isFree(tripod.position, 1.0f)) stations.push_back(tripod);
    }
  }
  for (int y = 0; y < blocks + 1; ++y) {  // between every other pair of crossings, to see behind parked cars
    for (int x = 0; x < blocks + 1; ++x) {
      Station tripod;
      const glm::vec2 half = (x + y) % 2 == 0 ? glm::vec2(0.5f, 0.0f) : glm::vec2(0.0f, 0.5f);
      const glm::vec2 at = glm::vec2(static_cast<float>(x), static_cast<float>(y)) + half;
      if (std::max(at.x, at.y) > static_cast<float>(blocks)) continue;
      tripod.position = {at.x * kPitch, at.y * kPitch, kTripodM};
      if (scene.isFree(tripod.position, 1.0f)) stations.push_back(tripod);
    }
  }
  Station square;  // between the fountain and the market
  const float middle = (static_cast<float>(blocks / 2) + 0.5f) * kPitch;
  square.position = {middle - 4.0f, middle - 8.0f, kTripodM};
  if (scene.isFree(square.position, 1.0f)) stations.push_back(square);
  for (int i = 0; i < blocks * blocks; ++i) {  // a drone over every block
    Station drone;
    drone.position = {(static_cast<float>(i % blocks) + 0.5f) * kPitch,
                      (static_cast<float>(i / blocks) + 0.5f) * kPitch, kDroneM};
    drone.lowest = -1.5707f;
    drone.highest = -0.35f;
    drone.reach = 190.0f;
    drone.solidAngle = true;
    drone.weight = 6.0f;
    stations.push_back(drone);
  }
  return stations;
}

}  // namespace

std::unique_ptr<ScannerScan> makeCity(std::uint64_t points, std::uint64_t seed) {
  const int blocks = blocksFor(points);
  SceneBuilder b(seed);
  for (int row = 0; row < blocks; ++row) {
    for (int column = 0; column < blocks; ++column) addBlock(b, column, row, blocks);
  }
  addOutskirts(b, blocks);
  const float low = -kOutskirts, high = static_cast<float>(blocks) * kPitch + kOutskirts;
  Scene scene(std::move(b.primitives), glm::vec2(low), glm::vec2(high), kCellM);
  constexpr double kMargin = 0.05;  // more than the noise of the range
  ShapeExtent extent;
  extent.origin = kOrigin;
  extent.min = {static_cast<double>(low) - kMargin, static_cast<double>(low) - kMargin, -kMargin};
  extent.max = {static_cast<double>(high) + kMargin, static_cast<double>(high) + kMargin,
                static_cast<double>(scene.top()) + kMargin};
  std::vector<Station> stations = stationsFor(scene, blocks);
  return std::make_unique<ScannerScan>(
      ScannedScene{std::move(scene), Material::street, Lighting{}, std::move(stations), extent}, points, seed);
}

}  // namespace strata::synthetic
