#pragma once
#include <algorithm>
#include <bit>
#include <string>
#include <vector>

#include "io/open_scans.h"
#include "io/scan/point_source.h"
#include "tests/support/synthetic_nodes.h"

namespace strata::test {

/// The first `most` points of a scan as a render list. Its nodes follow the order of the scan with up to 30 000 points
/// each, whose positions are rounded to multiples of `step` metres. Points that are not finite are left out. Throws
/// Error.
inline RenderList listOfScan(const std::string& input, std::size_t most, double step = 0.001) {
  std::vector<std::shared_ptr<const NodeData>> nodes;
  std::vector<glm::dvec3> points;
  std::size_t taken = 0;
  const auto finish = [&] {
    if (points.empty()) return;
    NodeKey key;
    for (std::size_t i = nodes.size() + 1; i > 0; i /= 8) key = key.child(static_cast<int>(i % 8));
    nodes.push_back(makeNode(key, points, step));
    points.clear();
  };
  for (const auto& source : openScans({input}, {}))
    for (std::size_t part = 0; part < source->partCount(); ++part) {
      const auto reader = source->openPart(part);
      for (PointBlock block; taken < most && reader->read(block, 10000);)
        for (const glm::dvec3& p : block.positions) {
          if (taken == most || !std::isfinite(p.x + p.y + p.z)) continue;
          points.push_back(p + source->info().origin);
          ++taken;
          if (points.size() == 30000) finish();
        }
    }
  finish();
  return makeList(nodes);
}

}  // namespace strata::test
