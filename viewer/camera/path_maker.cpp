#include "viewer/camera/path_maker.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "viewer/camera/composition.h"
#include "viewer/camera/stills.h"
#include "viewer/camera/street_search.h"

namespace strata {
namespace {

constexpr double kTau = 2.0 * std::numbers::pi;
constexpr double kOrbitElevation = std::numbers::pi / 6.0;
constexpr double kOrbitFovY = std::numbers::pi / 4.0;
constexpr double kSeconds = 12.0;      // of every path
constexpr double kOnePlace = 1e-9;     // of the coordinates: nearer than this is the same place
constexpr double kBesideAPoint = 1.0;  // metres
constexpr int kOrbitKeys = 16;
constexpr int kFlightKeys = 9;
constexpr double kWalkerHeight = 1.7;  // metres, or a share of the scan where that is small
constexpr int kPictureWidth = 1920;    // what paths are framed for
constexpr int kPictureHeight = 1080;

/// Unit vector along the longest horizontal spread of the points.
glm::dvec2 longAxis(const ScanSample& scan) {
  const glm::dvec2 centre(scan.bounds.centre());
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const glm::dvec3& p : scan.points) {
    const glm::dvec2 d = glm::dvec2(p) - centre;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
  }
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  return {std::cos(angle), std::sin(angle)};
}

/// Half the extent of the points along a horizontal direction.
double reachAlong(const ScanSample& scan, const glm::dvec2& axis) {
  double reach = 1e-3;
  for (const glm::dvec3& p : scan.points)
    reach = std::max(reach, std::abs(glm::dot(glm::dvec2(p) - glm::dvec2(scan.bounds.centre()), axis)));
  return reach;
}

/// The highest point in the cells around a place.
double topAround(const HeightGrid& grid, const glm::dvec2& place, int cells) {
  const glm::ivec2 middle = grid.cellOf(place);
  double top = grid.top(middle.x, middle.y);
  for (int row = std::max(0, middle.y - cells); row <= std::min(grid.rows() - 1, middle.y + cells); ++row)
    for (int column = std::max(0, middle.x - cells); column <= std::min(grid.columns() - 1, middle.x + cells); ++column)
      top = std::max(top, grid.top(column, row));
  return top;
}

double groundAt(const HeightGrid& grid, const glm::dvec2& place) {
  const glm::ivec2 cell = grid.cellOf(place);
  return grid.ground(cell.x, cell.y);
}

/// Eye height that works in a city, a room and around a figurine.
double walkerHeight(const ScanSample& scan) {
  return std::min(kWalkerHeight, 0.3 * std::max(scan.bounds.size().z, 0.02 * scan.diagonal()));
}

CameraPath circle(const glm::dvec3& target, double radius, double height) {
  CameraPath path;
  for (int i = 0; i < kOrbitKeys; ++i) {
    const double angle = kTau * i / kOrbitKeys - 0.25 * kTau;
    path.keys.push_back({kSeconds * i / kOrbitKeys,
                         target + glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), height),
                         target,
                         {0.0, 0.0, 1.0}});
  }
  path.keys.push_back(path.keys.front());
  path.keys.back().t = kSeconds;
  return path;
}

CameraPath divePath(const ScanSample& scan, const Store& store) {
  const std::vector<Still> stills = chooseStills(scan, store, kPictureWidth, kPictureHeight);
  const View& overview = stills[0].view;
  CameraPath path;
  path.fovY = overview.fovY;
  const auto add = [&](double share, const glm::dvec3& eye, const glm::dvec3& target) {
    path.keys.push_back({kSeconds * share, eye, target, {0.0, 0.0, 1.0}});
  };
  const double high = scan.enclosed ? 0.0 : 0.5 * stills[0].subject;
  add(0.0, overview.eye + glm::dvec3(0.0, 0.0, high), overview.target);
  add(0.35, glm::mix(overview.eye, stills[1].view.eye, 0.4), glm::mix(overview.target, stills[1].view.target, 0.7));
  add(0.65, stills[1].view.eye, stills[1].view.target);
  add(0.9, stills[2].view.eye, stills[2].view.target);
  add(1.0, glm::mix(stills[2].view.eye, stills[2].view.target, 0.15), stills[2].view.target);
  return path;
}

}  // namespace

CameraPath orbitPath(const ScanSample& scan) {
  CameraPath path;
  path.fovY = kOrbitFovY;
  const glm::dvec3 centre = scan.bounds.centre();
  std::vector<View> views;
  double farthest = 0.0;
  for (int i = 0; i < kOrbitKeys; ++i) {
    const glm::dvec3 direction = lookingAt(kTau * i / kOrbitKeys, kOrbitElevation);
    views.push_back(fittedView(scan, direction, kPictureWidth, kPictureHeight, path.fovY));
    farthest = std::max(farthest, glm::dot(centre - views.back().eye, direction));
  }
  // A scan in one place is looked at from beside it.
  if (!(farthest > kOnePlace * std::max(1.0, glm::length(centre)))) farthest = kBesideAPoint;
  // All from the same distance, so that the orbit does not breathe; stepping back loses nothing out of the picture.
  for (int i = 0; i <= kOrbitKeys; ++i) {
    const View& view = views[static_cast<std::size_t>(i % kOrbitKeys)];
    const glm::dvec3 direction = lookingAt(kTau * (i % kOrbitKeys) / kOrbitKeys, kOrbitElevation);
    const glm::dvec3 eye = view.eye - direction * (farthest - glm::dot(centre - view.eye, direction));
    path.keys.push_back({kSeconds * i / kOrbitKeys, eye, eye + direction * farthest, {0.0, 0.0, 1.0}});
  }
  return path;
}

CameraPath flythroughPath(const ScanSample& scan) {
  const HeightGrid grid(scan);
  const glm::dvec2 axis = longAxis(scan);
  const glm::dvec2 across(-axis.y, axis.x);
  const glm::dvec2 centre(scan.bounds.centre());
  const double length = reachAlong(scan, axis);
  const double width = reachAlong(scan, across);
  CameraPath path;
  for (int i = 0; i < kFlightKeys; ++i) {
    const double u = static_cast<double>(i) / (kFlightKeys - 1);
    // From before the scan to short of its end, swinging gently to both sides; inside a room from wall to wall.
    const double along = scan.enclosed ? -0.75 + 1.1 * u : -1.35 + 2.0 * u;
    const glm::dvec2 place = centre + axis * (along * length) + across * (0.35 * width * std::sin(kTau * u));
    const glm::dvec2 ahead = centre + axis * ((along + 0.6) * length) + across * (0.15 * width * std::sin(kTau * u));
    const double clearance = length * (0.30 - 0.18 * std::sin(std::numbers::pi * u));
    const double z =
        scan.enclosed ? scan.bounds.min.z + 0.6 * scan.bounds.size().z : topAround(grid, place, 3) + clearance;
    const double targetZ = scan.enclosed ? scan.bounds.min.z + 0.45 * scan.bounds.size().z : groundAt(grid, ahead);
    path.keys.push_back({kSeconds * u, glm::dvec3(place, z), glm::dvec3(ahead, targetZ), {0.0, 0.0, 1.0}});
  }
  return path;
}

CameraPath streetPath(const ScanSample& scan) {
  const double eyeHeight = walkerHeight(scan);
  if (scan.tallness() > 0.5 && !scan.enclosed) {
    // Nothing to walk through: a walk around it, looking at its middle.
    const glm::dvec3 size = scan.bounds.size();
    const double radius = 0.5 * std::hypot(size.x, size.y) + 0.9 * size.z;
    return circle(scan.bounds.centre(), radius, scan.bounds.min.z + eyeHeight - scan.bounds.centre().z);
  }
  const HeightGrid grid(scan);
  const std::vector<glm::dvec3> walk = findStreet(scan, grid, longAxis(scan), eyeHeight, kFlightKeys + 1);
  CameraPath path;
  for (std::size_t i = 0; i + 1 < walk.size(); ++i) {
    const glm::dvec3 ahead = glm::normalize(walk[i + 1] - walk[i]) * (8.0 * eyeHeight);
    path.keys.push_back({kSeconds * static_cast<double>(i) / static_cast<double>(walk.size() - 2),
                         walk[i],
                         walk[i] + glm::dvec3(glm::dvec2(ahead), ahead.z + 0.4 * eyeHeight),
                         {0.0, 0.0, 1.0}});
  }
  return path;
}

CameraPath makePath(const std::string& kind, const ScanSample& scan, const Store& store) {
  if (kind == "orbit") return orbitPath(scan);
  if (kind == "flythrough") return flythroughPath(scan);
  if (kind == "dive") return divePath(scan, store);
  if (kind == "street") return streetPath(scan);
  throw UsageError("--make-path", "unknown path, found " + kind + " (expected orbit, flythrough, dive or street)");
}

}  // namespace strata
