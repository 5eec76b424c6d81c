#include "tests/support/synthetic_nodes.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <random>

#include "tests/support/make_node.h"

namespace strata::test {
namespace {

double ground(double x, double y) { return 0.03 * (std::sin(7.0 * x) + std::cos(5.0 * y) + std::sin(9.0 * (x + y))); }

}  // namespace

std::shared_ptr<const NodeData> makeNode(NodeKey key, const std::vector<glm::dvec3>& points, double step,
                                         std::uint32_t batchPoints, int planes) {
  const std::shared_ptr<NodeData> node = makeNodeOf(key, points, step, batchPoints, planes);
  for (const glm::dvec3& p : points) {
    const glm::dvec3 wave = 127.5 + 127.5 * glm::sin(0.7 * (p - node->origin));
    node->colour.push_back(static_cast<std::uint32_t>(wave.x) | static_cast<std::uint32_t>(wave.y) << 8 |
                           static_cast<std::uint32_t>(wave.z) << 16 | 0xff000000u);
    node->intensity.push_back(static_cast<std::uint16_t>(257.0 * wave.z));
    node->classification.push_back(static_cast<std::uint8_t>(static_cast<int>(wave.x) % 19));
  }
  return node;
}

RenderList makeList(const std::vector<std::shared_ptr<const NodeData>>& nodes) {
  RenderList list;
  for (const auto& node : nodes) {
    list.items.push_back({node, node->pointCount()});
    list.pointCount += node->pointCount();
  }
  return list;
}

Box boundsOf(const RenderList& list) {
  Box box;
  for (const RenderItem& item : list.items)
    for (const Batch& batch : item.node->batches) {
      box.add(item.node->origin + batch.boxMin);
      box.add(item.node->origin + batch.boxMin + batch.boxSize);
    }
  return box;
}

RenderList makeTown(const glm::dvec3& centre, double side, std::uint32_t count, std::uint32_t seed, int tiles) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> bell(0.0, 0.01);
  std::vector<std::vector<glm::dvec3>> parts(static_cast<std::size_t>(2 * tiles * tiles));
  const auto add = [&](const glm::dvec3& p) {  // in units of the side
    const int column = std::clamp(static_cast<int>(p.x * tiles), 0, tiles - 1);
    const int row = std::clamp(static_cast<int>(p.y * tiles), 0, tiles - 1);
    parts[static_cast<std::size_t>((p.z > 0.05 ? tiles * tiles : 0) + row * tiles + column)].push_back(
        centre + (p - glm::dvec3(0.5, 0.5, 0.0)) * side);
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = unit(random), y = unit(random);
    add({x, y, ground(x, y)});
  }
  for (std::uint32_t i = 0; i < count / 8; ++i) {  // walls
    const int house = static_cast<int>(unit(random) * 9);
    const glm::dvec3 corner(0.1 + 0.3 * (house % 3), 0.1 + 0.3 * (house / 3), 0.0);
    glm::dvec3 p(unit(random), unit(random), unit(random));
    p[static_cast<int>(unit(random) * 2)] = unit(random) < 0.5 ? 0.0 : 1.0;
    add(corner + p * glm::dvec3(0.1, 0.12, 0.15));
    const int tree = static_cast<int>(unit(random) * 16);
    const glm::dvec3 top(0.06 + 0.24 * (tree % 4), 0.07 + 0.25 * (tree / 4), 0.12);
    add(top + glm::dvec3(bell(random), bell(random), bell(random)));
  }
  std::vector<std::shared_ptr<const NodeData>> nodes;
  for (std::vector<glm::dvec3>& part : parts) {
    if (part.empty()) continue;
    std::shuffle(part.begin(), part.end(), random);
    NodeKey key;
    for (std::size_t i = nodes.size(); i > 0 || key.isRoot(); i /= 8) key = key.child(static_cast<int>(i % 8));
    nodes.push_back(makeNode(key, part, 0.001));
  }
  return makeList(nodes);
}

std::vector<View> viewsAround(const Box& box, int count, int width, int height) {
  std::vector<View> views;
  for (int i = 0; i < count; ++i) {
    const double angle = glm::two_pi<double>() * i / count + 0.3;
    const glm::dvec3 direction(std::cos(angle), std::sin(angle), -0.25 - 0.1 * (i % 4));
    View view = viewOfBox(box, direction, width, height, 1.0);
    const double nearer[] = {1.0, 0.35, 0.08, 3.0};
    view.eye = view.target + (view.eye - view.target) * nearer[i % 4];
    if (i % 4 == 3) {
      view.orthographic = true;
      view.orthographicHeight = box.diagonal() * 0.6;
    }
    views.push_back(view);
  }
  return views;
}

}  // namespace strata::test
