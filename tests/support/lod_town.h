#pragma once
// A town in memory, with walls that hide things behind them, for measuring the cost of an LOD pass.

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "core/random.h"
#include "io/store/store.h"
#include "lod/streamed_node.h"
#include "tests/support/lod_store.h"
#include "tests/support/make_node.h"

namespace strata::test {

/// Square houses with flat roofs on a square grid of streets. The hierarchy is a quadtree over the ground, like the
/// octree of a scan that is wide and flat. All nodes hold the same number of points, half of them on walls if there are
/// any.
class Town {
 public:
  static constexpr double kBlock = 32.0,
                          kStreet = 10.0;  ///< metres from one house to the next, and of the street between them
  static constexpr double kLowest = 6.0, kHighest = 15.0;
  static constexpr int kSide = 128;  ///< a node has kSide squared points

  explicit Town(std::size_t nodes) {
    info.cubeBits = 22;  // 4 km in millimetres
    info.bounds = info.rootCube();
    std::vector<NodeKey> keys{NodeKey{}};
    for (std::size_t i = 0; i < keys.size(); ++i) {
      NodeRecord record = recordOf(keys[i]);
      if (keys.size() + 4 <= nodes) {
        record.firstChild = static_cast<std::uint32_t>(keys.size());
        for (const int octant : {0, 2, 4, 6}) {
          record.childMask = static_cast<std::uint8_t>(record.childMask | 1 << octant);
          keys.push_back(keys[i].child(octant));
        }
      }
      hierarchy.nodes.push_back(record);
      info.points += record.pointCount;
    }
    info.nodes = hierarchy.nodes.size();
  }

  /// A node as a loader would decode it, with the occluders that are found in its points.
  std::shared_ptr<StreamedNode> load(std::uint32_t index) const {
    const NodeRecord& record = hierarchy.nodes[index];
    const Box cube = nodeCube(NodeKey{record.key}, info.rootCube());
    std::mt19937_64 random(record.key);
    const auto in = [&random](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    std::vector<glm::dvec3> points;
    const double step = cube.size().x / kSide;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        glm::dvec3 p = cube.min + glm::dvec3((x + in(0.1, 0.9)) * step, (y + in(0.1, 0.9)) * step, 0.0);
        if (y % 2 == 0)
          p.z += houseAt(p);
        else
          p = ontoAWall(p, cube, in(0.0, 1.0));
        points.push_back(p);
      }
    auto node = std::make_shared<StreamedNode>();
    static_cast<NodeData&>(*node) = *makeNodeOf(NodeKey{record.key}, points, 1e-3);
    findOccluders(*node, cube, record.childMask, node->occluding);
    return node;
  }

  /// The view of somebody `height` metres above the middle of a street, looking along it.
  View along(double metres, double height) const {
    View view;
    const double street = (std::floor(0.5 * info.bounds.size().x / kBlock) + 1.0) * kBlock - 0.5 * kStreet;
    view.eye = info.bounds.min + glm::dvec3(street, 0.25 * info.bounds.size().y + metres, height);
    view.target = view.eye + glm::dvec3(0.3, 1.0, -0.1);
    return view;
  }

  StoreInfo info;
  Hierarchy hierarchy;

 private:
  static double within(double along) { return along - std::floor(along / kBlock) * kBlock; }
  /// The height of the roof over a place; 0 over a street.
  double houseAt(const glm::dvec3& p) const {
    const glm::dvec3 d = p - info.bounds.min;
    if (within(d.x) > kBlock - kStreet || within(d.y) > kBlock - kStreet) return 0.0;
    const auto seed =
        static_cast<std::uint64_t>(d.x / kBlock) * 7919 + static_cast<std::uint64_t>(d.y / kBlock) * 104729;
    return kLowest + (kHighest - kLowest) * static_cast<double>(seed * kSplitMixStep >> 40) / (1 << 24);
  }
  /// The point of a wall in the cube that is nearest to p, at a share of the wall's height; p if there is no wall.
  glm::dvec3 ontoAWall(glm::dvec3 p, const Box& cube, double share) const {
    const glm::dvec3 d = p - info.bounds.min;
    const glm::dvec3 corner = p - glm::dvec3(within(d.x), within(d.y), 0.0);
    const double side = kBlock - kStreet;
    glm::dvec3 wall = p;
    double nearest = kBlock;
    for (int axis = 0; axis < 2; ++axis)
      for (const double at : {corner[axis], corner[axis] + side}) {
        if (at < cube.min[axis] || at >= cube.max[axis] || std::abs(at - p[axis]) >= nearest) continue;
        if (p[1 - axis] > corner[1 - axis] + side) continue;
        nearest = std::abs(at - p[axis]);
        wall = p;
        wall[axis] = at;
      }
    const glm::dvec3 inside = glm::clamp(wall, corner + 0.01, corner + glm::dvec3(side - 0.01));
    wall.z = cube.min.z + share * houseAt(glm::dvec3(inside.x, inside.y, wall.z));
    return wall;
  }

  NodeRecord recordOf(NodeKey key) const {
    const Box cube = nodeCube(key, info.rootCube());
    NodeRecord record{};
    record.key = key.code;
    record.contourClass = static_cast<std::uint8_t>(ContourClass::planar);
    record.pointCount = kSide * kSide;
    record.prefixes = 1;
    record.prefix[0] = record.pointCount;
    record.spacing = static_cast<float>(cube.size().x / kSide);
    for (int axis = 0; axis < 3; ++axis) {
      const double half = axis == 2 ? 0.5 * kHighest : 0.5 * cube.size()[axis];
      record.halfAxis[axis][axis] = static_cast<float>(half);
      record.centre[axis] = cube.min[axis] + half;
    }
    return record;
  }
};

}  // namespace strata::test
