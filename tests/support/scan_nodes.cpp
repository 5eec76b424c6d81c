#include "tests/support/scan_nodes.h"

#include <algorithm>
#include <numeric>

#include "io/point_source.h"
#include "tests/support/synthetic_nodes.h"

namespace strata::test {
namespace {

constexpr std::size_t kNodePoints = 40000;
constexpr std::size_t kBlockPoints = 100000;

std::uint64_t mortonKey(const glm::dvec3& p, const Box& box) {
  const glm::dvec3 size = glm::max(box.max - box.min, 1e-9);
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell = static_cast<std::uint64_t>((p[axis] - box.min[axis]) / size[axis] * 2097151.0);
    for (int bit = 0; bit < 21; ++bit) key |= (cell >> bit & 1u) << (3 * bit + axis);
  }
  return key;
}

std::vector<glm::dvec3> readEvery(const PointSource& source, std::size_t step) {
  std::vector<glm::dvec3> points;
  PointBlock block;
  std::size_t number = 0;
  for (std::size_t part = 0; part < source.partCount(); ++part) {
    const std::unique_ptr<PointReader> reader = source.openPart(part);
    while (reader->read(block, kBlockPoints))
      for (const glm::dvec3& p : block.positions)
        if (number++ % step == 0) points.push_back(source.info().origin + p);
  }
  return points;
}

}  // namespace

RenderList scanAsNodes(const std::string& scan, std::size_t mostPoints) {
  const std::unique_ptr<PointSource> source = std::move(openSources({scan}, {}).front());
  const std::uint64_t count = source->info().pointCount;
  std::vector<glm::dvec3> points = readEvery(*source, std::max<std::size_t>(1, (count + mostPoints - 1) / mostPoints));
  Box box;
  for (const glm::dvec3& p : points) box.add(p);
  std::sort(points.begin(), points.end(),
            [&box](const glm::dvec3& a, const glm::dvec3& b) { return mortonKey(a, box) < mortonKey(b, box); });
  std::vector<std::shared_ptr<const NodeData>> nodes;
  for (std::size_t first = 0; first < points.size(); first += kNodePoints) {
    NodeKey key;
    for (std::size_t i = nodes.size(); i > 0 || key.isRoot(); i /= 8) key = key.child(static_cast<int>(i % 8));
    const auto begin = points.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = points.begin() + static_cast<std::ptrdiff_t>(std::min(first + kNodePoints, points.size()));
    nodes.push_back(makeNode(key, {begin, end}, 0.001));
  }
  return makeList(nodes);
}

}  // namespace strata::test
