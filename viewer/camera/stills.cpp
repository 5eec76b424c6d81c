#include "viewer/camera/stills.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>
#include <unordered_map>

#include "core/percentile.h"
#include "viewer/camera/composition.h"
#include "viewer/camera/dense_surface.h"

namespace strata {
namespace {

constexpr double kFovY = 45.0 * std::numbers::pi / 180.0;
constexpr double kRoomFovY = 75.0 * std::numbers::pi / 180.0;
constexpr int kDirections = 24;           // compass directions that are tried
constexpr double kFlatElevation = 0.62;   // radians over the horizon for a landscape ...
constexpr double kTallElevation = 0.28;   // ... and for a statue
constexpr double kCloseRadius = 0.13;     // of the scan's diagonal
constexpr double kDetailSpacingPx = 3.5;  // between neighbouring points in the detail picture
constexpr int kBlock = 24;                // pixels; in blocks of this the points are counted
constexpr std::size_t kLeastInBlock = 6;  // points; fewer are an edge or the haze around one
constexpr float kLayerDepth = 1.06f;      // what lies this much deeper is seen through the gaps of the front
constexpr double kClosedShare = 65.0;     // per cent of the picture's blocks that should look closed
constexpr double kOverlap =
    2.6;  // points do not stand on a grid: of 2, one place in fifty stays open, of 2.6 one in a thousand
constexpr int kLargestPoint = 2;      // pixels, for what is far away; near points have their size in metres
constexpr double kBlockedCost = 3.0;  // against coverage, when views are compared
constexpr double kLayeringGain = 0.3;

double elevationFor(const ScanSample& scan) {
  const double tall = std::clamp((scan.tallness() - 0.1) / 0.5, 0.0, 1.0);
  return kFlatElevation + (kTallElevation - kFlatElevation) * tall;
}

View viewFrom(const glm::dvec3& eye, const glm::dvec3& target, int width, int height, double fovY) {
  View view;
  view.eye = eye;
  view.target = target;
  view.width = width;
  view.height = height;
  view.fovY = fovY;
  return view;
}

double score(const Composition& c) { return c.coverage + kLayeringGain * c.layering - kBlockedCost * c.blocked; }

/// Keeps the best of the views offered.
struct BestView {
  std::optional<View> view;
  double score = 0.0;

  void offer(const View& candidate, double candidateScore) {
    if (view && candidateScore <= score) return;
    view = candidate;
    score = candidateScore;
  }
};

/// From an upper corner of the room, looking down at the opposite side.
View roomView(const ScanSample& scan, int width, int height) {
  const glm::dvec3 centre = scan.bounds.centre();
  const glm::dvec3 half = 0.5 * scan.bounds.size();
  BestView best;
  for (int corner = 0; corner < 4; ++corner) {
    const glm::dvec2 side(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0);
    for (const double inset : {0.9, 0.75, 0.6}) {
      const glm::dvec3 eye = centre + glm::dvec3(side * glm::dvec2(half) * inset, half.z * 0.55);
      const glm::dvec3 target = centre + glm::dvec3(-side * glm::dvec2(half) * 0.25, -half.z * 0.35);
      const View view = viewFrom(eye, target, width, height, kRoomFovY);
      best.offer(view, score(compose(scan, view, glm::distance(eye, target))) + 0.3 * inset);
    }
  }
  return *best.view;
}

/// Where much surface lies close together: the occupied voxels, and for each how many others are near.
struct Spot {
  glm::dvec3 centre{0.0};  ///< mean of the surface around the best place
  double radius = 0.0;
};

Spot richestSpot(const ScanSample& scan, const Store& store) {
  const double edge = scan.diagonal() / 80.0;
  Spot spot{scan.bounds.centre(), kCloseRadius * scan.diagonal()};
  if (edge <= 0.0) return spot;
  struct Voxel {
    glm::dvec3 sum{0.0};
    double count = 0.0;
    double weight = 0.0;
  };
  std::unordered_map<std::uint64_t, Voxel> voxels;
  for (const glm::dvec3& p : scan.points) {
    const glm::dvec3 cell = (p - scan.bounds.min) / edge;
    Voxel& voxel = voxels[static_cast<std::uint64_t>(cell.x) << 40 | static_cast<std::uint64_t>(cell.y) << 20 |
                          static_cast<std::uint64_t>(cell.z)];
    voxel.sum += p;
    voxel.count += 1.0;
  }
  std::vector<std::pair<glm::dvec3, double>> places;  // centre, weight
  std::vector<double> spacings;
  for (const auto& [key, voxel] : voxels) {
    places.emplace_back(voxel.sum / voxel.count, localNode(store, voxel.sum / voxel.count).spacing);
    spacings.push_back(places.back().second);
  }
  std::nth_element(spacings.begin(), spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2),
                   spacings.end());
  const double typical = spacings[spacings.size() / 2];
  for (auto& [place, weight] : places) weight = weight > 0.0 ? std::clamp(typical / weight, 0.25, 1.5) : 1.0;
  // In a fixed order, so that ties and rounding fall the same way in every run.
  std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first.x, a.first.y, a.first.z) < std::tie(b.first.x, b.first.y, b.first.z);
  });
  double best = -1.0;
  const std::size_t step = std::max<std::size_t>(1, places.size() / 1500);
  for (std::size_t i = 0; i < places.size(); i += step) {
    glm::dvec3 sum(0.0);
    double weight = 0.0;
    for (const auto& [place, placeWeight] : places) {
      if (glm::distance(place, places[i].first) > spot.radius) continue;
      sum += place * placeWeight;
      weight += placeWeight;
    }
    // Near the middle the neighbourhood is whole; the edge of a scan often is ragged.
    const double outward =
        glm::distance(glm::dvec2(places[i].first), glm::dvec2(scan.bounds.centre())) / std::max(scan.diagonal(), 1e-9);
    const double value = weight * (1.0 - 0.6 * outward);
    if (value <= best) continue;
    best = value;
    spot.centre = sum / weight;
  }
  return spot;
}

bool inside(const ScanSample& scan, const glm::dvec3& place) { return !scan.enclosed || scan.bounds.contains(place); }

/// Unit normal of a flat node's contour, or nothing.
std::optional<glm::dvec3> surfaceNormal(const NodeRecord& node) {
  int thin = 0;
  double lengths[3];
  for (int i = 0; i < 3; ++i) lengths[i] = std::hypot(node.halfAxis[i][0], node.halfAxis[i][1], node.halfAxis[i][2]);
  for (int i = 1; i < 3; ++i) thin = lengths[i] < lengths[thin] ? i : thin;
  const double longest = *std::max_element(lengths, lengths + 3);
  if (static_cast<ContourClass>(node.contourClass) != ContourClass::planar || lengths[thin] > 0.3 * longest)
    return std::nullopt;
  const glm::dvec3 a(node.halfAxis[(thin + 1) % 3][0], node.halfAxis[(thin + 1) % 3][1],
                     node.halfAxis[(thin + 1) % 3][2]);
  const glm::dvec3 b(node.halfAxis[(thin + 2) % 3][0], node.halfAxis[(thin + 2) % 3][1],
                     node.halfAxis[(thin + 2) % 3][2]);
  const glm::dvec3 normal = glm::cross(a, b);
  return glm::length(normal) > 0.0 ? std::optional(glm::normalize(normal)) : std::nullopt;
}

}  // namespace

Still overviewStill(const ScanSample& scan, int width, int height) {
  if (scan.enclosed) {
    const View view = roomView(scan, width, height);
    return {"overview", view, glm::distance(view.eye, view.target)};
  }
  BestView best;
  for (int i = 0; i < kDirections; ++i) {
    const double azimuth = 2.0 * std::numbers::pi * i / kDirections;
    const View view = fittedView(scan, lookingAt(azimuth, elevationFor(scan)), width, height, kFovY);
    best.offer(view, score(compose(scan, view, 0.0)));
  }
  return {"overview", *best.view, glm::distance(best.view->eye, best.view->target)};
}

Still closeStill(const ScanSample& scan, const Store& store, int width, int height) {
  const Spot spot = richestSpot(scan, store);
  const double fovY = scan.enclosed ? kRoomFovY : kFovY;
  const double whole = 0.85 * spot.radius / std::sin(0.5 * fovY);
  BestView best;
  for (const double share : {1.0, 0.75, 0.55})
    for (const double elevation : {0.75 * elevationFor(scan), 0.4 * elevationFor(scan)})
      for (int i = 0; i < kDirections; ++i) {
        const double azimuth = 2.0 * std::numbers::pi * i / kDirections;
        const glm::dvec3 eye = spot.centre - lookingAt(azimuth, elevation) * (whole * share);
        if (!inside(scan, eye)) continue;
        const View view = viewFrom(eye, spot.centre, width, height, fovY);
        best.offer(view, score(compose(scan, view, whole * share)) + 0.3 * share);
      }
  if (!best.view) best.view = viewFrom(scan.bounds.centre(), spot.centre + 1e-3, width, height, fovY);
  return {"close", *best.view, glm::distance(best.view->eye, best.view->target)};
}

Still detailStill(const ScanSample& scan, const Store& store, const Still& close, int width, int height) {
  const DensePlace dense = densePlace(store, close.view.target, 0.7 * kCloseRadius * scan.diagonal());
  const glm::dvec3 place = dense.centre;
  const std::optional<glm::dvec3> normal = surfaceNormal(store.hierarchy().nodes[localNode(store, place).index]);
  const double fovY = close.view.fovY;
  const double focal = 0.5 * height / std::tan(0.5 * fovY);
  const double distance =
      std::clamp(dense.spacing * focal / kDetailSpacingPx, 0.08 * close.subject, 0.45 * close.subject);
  BestView best;
  for (const double elevation : {0.2, 0.45, 0.75})
    for (int i = 0; i < kDirections; ++i) {
      const glm::dvec3 direction = lookingAt(2.0 * std::numbers::pi * i / kDirections, elevation);
      const glm::dvec3 eye = place - direction * distance;
      if (!inside(scan, eye)) continue;
      const View view = viewFrom(eye, place, width, height, fovY);
      const double facing = normal ? std::abs(glm::dot(*normal, direction)) : 0.5;
      // Face-on is flat and edge-on shows nothing: about 40 degrees off the normal is best.
      best.offer(view, score(compose(scan, view, distance)) - std::abs(facing - 0.75));
    }
  if (!best.view) best.view = viewFrom(glm::mix(close.view.eye, place, 0.5), place, width, height, fovY);
  return {"detail", *best.view, distance};
}

std::vector<Still> chooseStills(const ScanSample& scan, const Store& store, int width, int height) {
  std::vector<Still> stills{overviewStill(scan, width, height), closeStill(scan, store, width, height)};
  stills.push_back(detailStill(scan, store, stills[1], width, height));
  for (Still& still : stills) still.view.nearPlane = std::min(0.01, 1e-3 * still.subject);
  return stills;
}

FrontSpacing frontSpacing(const Picture& picture, const View& view) {
  struct Block {
    double depth, pixels;
  };
  std::vector<Block> blocks;
  std::vector<float> depths;
  for (int y = 0; y + kBlock <= picture.height; y += kBlock)
    for (int x = 0; x + kBlock <= picture.width; x += kBlock) {
      depths.clear();
      for (int v = 0; v < kBlock; ++v)
        for (int u = 0; u < kBlock; ++u) {
          const std::size_t pixel = static_cast<std::size_t>(y + v) * static_cast<std::size_t>(picture.width) +
                                    static_cast<std::size_t>(x + u);
          if (picture.pointId[pixel] != Picture::kNoPoint) depths.push_back(picture.depth[pixel]);
        }
      if (depths.size() < kLeastInBlock) continue;
      const auto tenth = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 10);
      std::nth_element(depths.begin(), tenth, depths.end());
      const float behind = *tenth * kLayerDepth;
      const auto front = std::count_if(depths.begin(), depths.end(), [&](float depth) { return depth < behind; });
      blocks.push_back({static_cast<double>(*tenth), kBlock / std::sqrt(static_cast<double>(front))});
    }
  std::sort(blocks.begin(), blocks.end(), [](const Block& a, const Block& b) { return a.depth < b.depth; });
  std::vector<double> pixels, metres;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    pixels.push_back(blocks[i].pixels);
    // Far away the level of detail decides the spacing; near the eye it is the scan's own.
    if (2 * i <= blocks.size()) metres.push_back(blocks[i].pixels / pixelsAt(view, 1.0, blocks[i].depth));
  }
  return {percentile(pixels, kClosedShare), percentile(metres, kClosedShare)};
}

int closedPointSize(double spacingPx) {
  return std::clamp(static_cast<int>(std::ceil(kOverlap * spacingPx)), 1, kLargestPoint);
}

float closedPointMetres(double spacing) { return static_cast<float>(kOverlap * spacing); }

Still fartherStill(const Still& still, double factor) {
  Still next = still;
  next.view.eye = still.view.target + (still.view.eye - still.view.target) * factor;
  next.subject = still.subject * factor;
  return next;
}

}  // namespace strata
