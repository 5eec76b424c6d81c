#include "tests/bench/suites/clouds.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "core/random.h"
#include "render/thread_pool.h"
#include "tests/support/make_node.h"

namespace strata::suite {
namespace {

constexpr double kGridStep = 0.001;  ///< metres

double randomOf(std::uint64_t i) { return unitInterval(splitMix64(i)); }

std::uint64_t evenBits(std::uint64_t v) {
  v &= 0x5555555555555555u;
  v = (v | v >> 1) & 0x3333333333333333u;
  v = (v | v >> 2) & 0x0f0f0f0f0f0f0f0fu;
  v = (v | v >> 4) & 0x00ff00ff00ff00ffu;
  v = (v | v >> 8) & 0x0000ffff0000ffffu;
  return (v | v >> 16) & 0xffffffffu;
}

/// Place of point i of a square in Morton order, 0 to 1, jittered within its
/// cell.
glm::dvec2 inSquare(std::uint64_t i, std::uint64_t count) {
  const double t = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
  const auto code = static_cast<std::uint64_t>(t * 0x1p52);
  const glm::dvec2 cell(static_cast<double>(evenBits(code)), static_cast<double>(evenBits(code >> 1)));
  const double jitter = 0.7 / std::sqrt(static_cast<double>(count));
  return glm::clamp(cell * 0x1p-26 + jitter * glm::dvec2(randomOf(2 * i) - 0.5, randomOf(2 * i + 1) - 0.5), 0.0, 1.0);
}

double height(const glm::dvec2& p) {
  return 0.03 * (std::sin(7.0 * p.x) + std::cos(5.0 * p.y) + std::sin(9.0 * (p.x + p.y))) +
         0.002 * std::sin(211.0 * p.x) * std::sin(173.0 * p.y);
}

View lookAt(const glm::dvec3& eye, const glm::dvec3& target) {
  View view;
  view.eye = eye;
  view.target = target;
  return view;
}

constexpr int kCurveBits = 21;

glm::u64vec3 curveCell(const glm::dvec3& p) {  // p in 0 to 1
  return glm::u64vec3(glm::clamp(p, 0.0, 1.0) * ((1 << kCurveBits) - 1.0));
}

/// Bit b of x, y and z are bits 3b + 2, 3b + 1 and 3b.
std::uint64_t interleave(const glm::u64vec3& cell) {
  std::uint64_t key = 0;
  for (int bit = 0; bit < kCurveBits; ++bit)
    for (int axis = 0; axis < 3; ++axis) key |= (cell[axis] >> bit & 1u) << (3 * bit + 2 - axis);
  return key;
}

/// Skilling 2004, "Programming the Hilbert curve": undo the excess work from
/// the top bit down, then Gray code.
std::uint64_t hilbertKey(glm::u64vec3 x) {
  for (std::uint64_t q = std::uint64_t{1} << (kCurveBits - 1); q > 1; q >>= 1)
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint64_t lower = q - 1;
      if ((x[axis] & q) != 0) {
        x[0] ^= lower;
      } else {
        const std::uint64_t swapped = (x[0] ^ x[axis]) & lower;
        x[0] ^= swapped;
        x[axis] ^= swapped;
      }
    }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint64_t flip = 0;
  for (std::uint64_t q = std::uint64_t{1} << (kCurveBits - 1); q > 1; q >>= 1)
    if ((x[2] & q) != 0) flip ^= q - 1;
  return interleave(x ^ glm::u64vec3(flip));
}

/// Nodes of points [0, count) given by `at`, made by all cores.
RenderList makeNodes(std::uint64_t count, std::uint32_t nodePoints,
                     const std::function<glm::dvec3(std::uint64_t)>& at) {
  const std::uint64_t nodeCount = (count + nodePoints - 1) / nodePoints;
  std::vector<std::shared_ptr<const NodeData>> nodes(nodeCount);
  ThreadPool(0).parallelFor(nodeCount, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      std::vector<glm::dvec3> points;
      for (std::uint64_t i = n * nodePoints; i < std::min<std::uint64_t>(count, (n + 1) * nodePoints); ++i)
        points.push_back(at(i));
      nodes[n] = colouredNode(points, kGridStep, 3);
    }
  });
  return listOf(nodes);
}

}  // namespace

std::shared_ptr<const NodeData> colouredNode(const std::vector<glm::dvec3>& points, double step, int planes) {
  const std::shared_ptr<NodeData> node = makeNodeOf({}, points, step, Batch::kMaxPoints, planes);
  node->colour.reserve(points.size());
  for (const glm::dvec3& p : points) {
    const glm::uvec3 wave(127.5 + 127.5 * glm::sin(0.7 * (p - node->origin)));
    node->colour.push_back(wave.x | wave.y << 8 | wave.z << 16 | 0xff000000u);
  }
  return node;
}

RenderList listOf(const std::vector<std::shared_ptr<const NodeData>>& nodes) {
  RenderList list;
  for (const auto& node : nodes) {
    list.items.push_back({node, node->pointCount()});
    list.pointCount += node->pointCount();
  }
  return list;
}

Cloud groundCloud(const std::string& name, std::uint64_t count, double side) {
  Cloud cloud{name, count, {}, {}, {}};
  cloud.point = [count, side](std::uint64_t i) {
    const glm::dvec2 p = inSquare(i, count);
    return glm::dvec3(p, height(p)) * side;
  };
  cloud.outside = lookAt(glm::dvec3(-0.35, -0.3, 0.45) * side, glm::dvec3(0.5, 0.5, 0.0) * side);
  cloud.inside = lookAt(glm::dvec3(0.3, 0.3, 0.15) * side, glm::dvec3(0.6, 0.6, 0.0) * side);
  return cloud;
}

Cloud buildingCloud(const std::string& name, std::uint64_t count) {
  constexpr std::uint64_t kWalls = 64;                        // 4 x 4 rooms of 4 walls
  constexpr double kSide = 40.0, kRoom = 8.0, kHeight = 6.0;  // metres
  const std::uint64_t ground = count / 4, wall = std::max<std::uint64_t>((count - ground) / kWalls, 1);
  Cloud cloud{name, count, {}, {}, {}};
  cloud.point = [=](std::uint64_t i) {
    if (i < ground) {
      const glm::dvec2 p = inSquare(i, ground);
      return glm::dvec3(p * kSide, 0.2 * height(p) * kSide);
    }
    const std::uint64_t which = std::min((i - ground) / wall, kWalls - 1);
    const glm::dvec2 p = inSquare((i - ground - which * wall) % wall, wall);
    const std::uint64_t room = which / 4;
    const glm::dvec3 corner(4.0 + kRoom * static_cast<double>(room % 4), 4.0 + kRoom * static_cast<double>(room / 4),
                            0.0);
    const double along = 0.2 + (kRoom - 0.4) * p.x, rough = 0.01 * randomOf(i);
    const double across = (which % 2 == 0 ? 0.2 : kRoom - 0.2) + rough;
    return corner +
           (which % 4 < 2 ? glm::dvec3(along, across, kHeight * p.y) : glm::dvec3(across, along, kHeight * p.y));
  };
  cloud.outside = lookAt({-18.0, -14.0, 22.0}, {20.0, 20.0, 2.0});
  cloud.inside = lookAt({13.0, 13.0, 1.7}, {20.0, 21.0, 2.2});
  return cloud;
}

Cloud scannerCloud(const std::string& name, std::uint64_t count) {
  const auto columns = static_cast<std::uint64_t>(std::sqrt(2.0 * static_cast<double>(count)));
  const std::uint64_t rows = std::max<std::uint64_t>(count / columns, 1);
  Cloud cloud{name, columns * rows, {}, {}, {}};
  cloud.point = [=](std::uint64_t i) {
    const double yaw = glm::two_pi<double>() * static_cast<double>(i / rows) / static_cast<double>(columns);
    const double pitch = glm::pi<double>() * ((static_cast<double>(i % rows) + 0.5) / static_cast<double>(rows) - 0.5);
    const glm::dvec3 ray(std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch));
    const glm::dvec3 far(ray.x > 0.0 ? 22.0 : 9.0, ray.y > 0.0 ? 14.0 : 6.0,
                         ray.z > 0.0 ? 5.0 : 1.7);  // a hall
    const glm::dvec3 hit = far / glm::max(glm::abs(ray), 1e-9);
    return ray * (std::min({hit.x, hit.y, hit.z}) * (1.0 + 0.003 * randomOf(i)));
  };
  cloud.outside = lookAt({-35.0, -25.0, 25.0}, {5.0, 3.0, 0.0});
  cloud.inside = lookAt({0.5, 0.2, 0.3}, {10.0, 4.0, 0.0});
  return cloud;
}

RenderList unstructured(const Cloud& cloud, std::uint32_t nodePoints) {
  return makeNodes(cloud.count, nodePoints, cloud.point);
}

RenderList sorted(const Cloud& cloud, Curve curve, std::uint32_t nodePoints) {
  Box box;
  for (std::uint64_t i = 0; i < cloud.count; i += 1 + cloud.count / 100000) box.add(cloud.point(i));
  const glm::dvec3 size = box.max - box.min;
  const double side = std::max({size.x, size.y, size.z});
  std::vector<std::pair<std::uint64_t, std::uint64_t>> order(cloud.count);
  ThreadPool(0).parallelFor(cloud.count, 100000, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const glm::u64vec3 cell = curveCell((cloud.point(i) - box.min) / side);
      order[i] = {curve == Curve::morton ? interleave(cell) : hilbertKey(cell), i};
    }
  });
  std::sort(order.begin(), order.end());
  return makeNodes(cloud.count, nodePoints, [&](std::uint64_t i) { return cloud.point(order[i].second); });
}

RenderList layered(const Cloud& cloud, std::uint32_t nodePoints) {
  RenderList list;
  std::uint64_t stride = 1;
  for (std::uint64_t kept = cloud.count; kept > 0; stride *= 4) {
    const std::uint64_t coarser = kept <= nodePoints ? 0 : kept / 4;  // points at 0, 4, 8, ... of this level
    const std::uint64_t here = kept - coarser;
    const auto at = [&, coarser](std::uint64_t i) {
      if (coarser == 0) return cloud.point(i * stride);
      const std::uint64_t skipped = std::min(i / 3 + 1, coarser);
      return cloud.point(std::min((i + skipped) * stride, cloud.count - 1));
    };
    RenderList level = makeNodes(here, nodePoints, at);
    list.items.insert(list.items.begin(), level.items.begin(), level.items.end());
    list.pointCount += level.pointCount;
    kept = coarser;
  }
  return list;
}

}  // namespace strata::suite
