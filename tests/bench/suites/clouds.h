#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/render_list.h"

namespace strata::suite {

/// A made scan: `point(i)` is point i of `count`, in the order that its file
/// would have. Any thread may ask.
struct Cloud {
  std::string name;
  std::uint64_t count = 0;
  std::function<glm::dvec3(std::uint64_t)> point;
  View outside, inside;
};

/// Waves of ground in 2D Morton order, as an airborne or photogrammetric scan
/// after sorting; few points hide others.
Cloud groundCloud(const std::string& name, std::uint64_t count, double side);
/// Ground with a building of rooms on it, each wall in Morton order: many
/// points hide others.
Cloud buildingCloud(const std::string& name, std::uint64_t count);
/// What a terrestrial scanner in a room records: one column of the sphere after
/// the other (Schütz 2022, 4.2).
Cloud scannerCloud(const std::string& name, std::uint64_t count);

/// A node of these points on a grid of `step` metres, with colours that follow from the position; in as many planes as
/// that takes or `planes` where it is not 0.
std::shared_ptr<const NodeData> colouredNode(const std::vector<glm::dvec3>& points, double step, int planes = 0);
/// Every point of each node.
RenderList listOf(const std::vector<std::shared_ptr<const NodeData>>& nodes);

/// Consecutive points in nodes of at most `nodePoints` and batches of 10 240,
/// on a grid of 1 mm.
RenderList unstructured(const Cloud& cloud, std::uint32_t nodePoints);
enum class Curve { morton, hilbert };
/// The same points sorted along a curve through 2^21 cells an axis of the
/// cloud's bounding cube.
RenderList sorted(const Cloud& cloud, Curve curve, std::uint32_t nodePoints);
/// Layered: a quarter of the points, evenly spread, is kept for the next
/// coarser level, and so on; each level in nodes of at most `nodePoints`
/// consecutive points. Every point once, as in Potree (Schütz 2022, 3.5).
RenderList layered(const Cloud& cloud, std::uint32_t nodePoints);

}  // namespace strata::suite
