#include "io/store/verify.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "io/store/node_codec.h"
#include "io/store/store_files.h"

namespace strata {
namespace {

/// The contour's half-axes are floats and its centre is a sum, so points may lie outside by this share of their
/// distance.
constexpr double kContourSlack = 1e-6;

void checkPoints(const NodeRecord& record, const NodePoints& points, const StoreInfo& info) {
  const std::string name = "node " + NodeKey{record.key}.text();
  const Box cube = nodeCube(NodeKey{record.key}, info.rootCube());
  const glm::dvec3 centre(record.centre[0], record.centre[1], record.centre[2]);
  const glm::dvec3 half = glm::dvec3(0.5) * info.grid.scale;
  for (std::size_t i = 0; i < points.count(); ++i) {
    const glm::dvec3 p =
        info.grid.offset + info.grid.scale * glm::dvec3(points.grid[0][i], points.grid[1][i], points.grid[2][i]);
    if (!glm::all(glm::greaterThan(p, cube.min - half)) || !glm::all(glm::lessThan(p, cube.max + half)))
      throw Error("points.bin", name + ": a point lies outside the node's cube");
    for (const auto& axis : record.halfAxis) {
      const glm::dvec3 a(axis[0], axis[1], axis[2]);
      const double length = glm::length(a);
      const double slack = kContourSlack * (length + glm::length(p - centre)) + glm::length(info.grid.scale);
      if (length > 0.0 && std::abs(glm::dot(p - centre, a / length)) > length + slack)
        throw Error("points.bin", name + ": a point lies outside the node's contour");
    }
  }
}

/// Payloads must follow each other without gaps, so that a checksum covers every byte.
void checkCoverage(const Store& store, VerifyReport& report) {
  std::vector<const NodeRecord*> byOffset;
  for (const NodeRecord& record : store.hierarchy().nodes) byOffset.push_back(&record);
  std::sort(byOffset.begin(), byOffset.end(),
            [](const NodeRecord* a, const NodeRecord* b) { return a->offset < b->offset; });
  std::uint64_t end = sizeof(PointsHeader);
  for (const NodeRecord* record : byOffset) {
    if (record->offset != end) {
      report.problems.push_back("points.bin: bytes that belong to no node before " + NodeKey{record->key}.text());
      return;
    }
    end += record->payloadBytes;
  }
  if (end != store.points().size()) report.problems.push_back("points.bin: bytes behind the last node");
}

}  // namespace

VerifyReport verifyStore(const Store& store) {
  VerifyReport report;
  const std::vector<NodeRecord>& nodes = store.hierarchy().nodes;
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    ++report.checkedNodes;
    try {
      const NodePoints points = readAll(store, i);
      checkPoints(nodes[i], points, store.info());
      report.points += points.count();
    } catch (const Error& problem) {
      ++report.badNodes;
      report.problems.push_back(problem.what());
    }
  }
  checkCoverage(store, report);
  if (report.badNodes == 0 && report.points != store.info().points)
    report.problems.push_back("store.json: point count, found " + std::to_string(report.points) +
                              " in the nodes (expected " + std::to_string(store.info().points) + ")");
  return report;
}

}  // namespace strata
