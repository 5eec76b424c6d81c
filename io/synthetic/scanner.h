#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "io/synthetic/scene.h"
#include "io/synthetic/shape.h"

namespace strata::synthetic {

/// One place that a scanner stood at. Its rays are uniform in azimuth. Those of a tripod are uniform in elevation too,
/// as a turning mirror sends them, so that N rays from the height h put N h / (2 pi (e1 - e0) r (r^2 + h^2)) points on
/// each square metre of level ground at the distance r. Those from the air are uniform in solid angle.
struct Station {
  glm::vec3 position{0.0f};
  float lowest = -1.05f, highest = 1.3f;  ///< elevation, radians
  float reach = 120.0f;                   ///< metres; farther surfaces give no echo
  bool solidAngle = false;
  float weight = 1.0f;  ///< relative number of points per radian of azimuth and elevation
};

/// The light in which the camera saw the scene.
struct Lighting {
  bool indoor = false;
  glm::vec3 sun{-0.52f, -0.42f, 0.74f};  ///< unit, towards the sun (outdoors)
  std::vector<float> lampRows;           ///< y of the rows of ceiling lamps (indoors)
  float lampPitch = 2.4f;                ///< x from lamp to lamp; the first at half of it
  float lampHeight = 2.8f;
};

/// A scene, and the stations that it is scanned from.
struct ScannedScene {
  Scene scene;
  Material ground;  ///< at z = 0
  Lighting lighting;
  std::vector<Station> stations;  ///< every one of them has a surface below it
  ShapeExtent extent;
};

/// A scene as laser scanners see it: first surfaces alone, with noise of some millimetres along the ray. The points of
/// one station follow each other, and run round its azimuth as those of a real scanner do.
class ScannerScan final : public Shape {
 public:
  static constexpr float kNoiseM = 0.002f;  ///< standard deviation of the range

  ScannerScan(ScannedScene scanned, std::uint64_t points, std::uint64_t seed);

  const ShapeExtent& extent() const override { return extent_; }
  void generate(std::uint64_t first, std::span<ShapePoint> out) const override;

  const Scene& scene() const { return scene_; }
  const std::vector<Station>& stations() const { return stations_; }
  std::size_t stationOf(std::uint64_t point) const;

 private:
  /// The elevation above which there is only sky, for equal bins of azimuth. Rays are drawn below it, so that few are
  /// drawn in vain.
  struct Horizon {
    static constexpr int kBins = 1024;
    std::vector<float> highest;     ///< elevation (or its sine), kBins
    std::vector<float> cumulative;  ///< area below the horizon, kBins + 1, from 0 to 1
    float lowest = 0.0f;
    float area = 0.0f;
  };
  Horizon horizonOf(const Station& station) const;
  /// The direction at `u` in [0, 1) of the station's sweep; `v` in [0, 1) picks the elevation.
  glm::vec3 direction(const Station& station, const Horizon& horizon, float u, float v) const;
  void measure(std::size_t station, double sweep, std::uint64_t point, ShapePoint& out) const;
  Surface surfaceOf(const Ray& ray, Hit& hit, glm::vec3& normal) const;
  glm::vec3 light(const glm::vec3& position, const glm::vec3& normal, std::uint64_t raySeed) const;

  Scene scene_;
  Material ground_;
  Lighting lighting_;
  std::vector<Station> stations_;
  ShapeExtent extent_;
  std::uint64_t key_;
  std::vector<Horizon> horizons_;
  std::vector<std::uint64_t> firstPoint_;  ///< of each station, then the number of points
};

}  // namespace strata::synthetic
