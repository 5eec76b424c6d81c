#include "converter/normals/nearest_points.h"

#include <algorithm>
#include <numeric>

namespace strata {
namespace {

constexpr std::uint32_t kLeafPoints = 12;
/// Rounding may take as much off the square of a distance to a box.
constexpr double kSlack = 1.0 + 1e-12;

double square(const glm::dvec3& v) { return glm::dot(v, v); }

}  // namespace

struct NearestPoints::Search {
  struct Found {
    double square;
    std::uint32_t index;  ///< ascending in x, y, z
    bool operator<(const Found& other) const {
      return square < other.square || (square == other.square && index < other.index);
    }
  };
  glm::dvec3 from;
  std::size_t count;
  double farthest;           ///< square of the distance beyond which nothing counts any more
  std::vector<Found> found;  ///< a heap, the farthest on top
};

NearestPoints::NearestPoints(const std::vector<glm::dvec3>& points) : points_(points), order_(points.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.reserve(points.size() / kLeafPoints * 4 + 1);
  if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
}

void NearestPoints::build(std::uint32_t begin, std::uint32_t end) {
  const auto node = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({0.0, begin, end, 0, 0});
  if (end - begin <= kLeafPoints) return;
  glm::dvec3 low = points_[order_[begin]], high = low;
  for (std::uint32_t i = begin; i < end; ++i) {
    low = glm::min(low, points_[order_[i]]);
    high = glm::max(high, points_[order_[i]]);
  }
  const glm::dvec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::uint32_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end),
                   [&](std::uint32_t a, std::uint32_t b) { return points_[a][axis] < points_[b][axis]; });
  nodes_[node].axis = static_cast<std::uint32_t>(axis);
  nodes_[node].split = points_[order_[middle]][axis];
  build(begin, middle);
  nodes_[node].right = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end);
}

void NearestPoints::visit(std::uint32_t index, glm::dvec3 beyond, Search& search) const {
  const Node& node = nodes_[index];
  if (node.right == 0) {
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const Search::Found candidate{square(points_[order_[i]] - search.from), order_[i]};
      if (candidate.square > search.farthest) continue;
      if (search.found.size() == search.count) {
        if (!(candidate < search.found.front())) continue;
        std::pop_heap(search.found.begin(), search.found.end());
        search.found.pop_back();
      }
      search.found.push_back(candidate);
      std::push_heap(search.found.begin(), search.found.end());
      if (search.found.size() == search.count) search.farthest = search.found.front().square;
    }
    return;
  }
  const int axis = static_cast<int>(node.axis);
  const double across = search.from[axis] - node.split;
  const std::uint32_t near = across < 0.0 ? index + 1 : node.right, far = across < 0.0 ? node.right : index + 1;
  visit(near, beyond, search);
  beyond[axis] = across;
  if (square(beyond) <= search.farthest * kSlack) visit(far, beyond, search);
}

void NearestPoints::find(std::uint32_t index, std::size_t count, double reach,
                         std::vector<std::uint32_t>& found) const {
  thread_local std::vector<Search::Found> heap;
  Search search{points_[index], count, reach * reach, std::move(heap)};
  search.found.clear();
  visit(0, glm::dvec3(0.0), search);
  std::sort_heap(search.found.begin(), search.found.end());
  found.clear();
  for (const Search::Found& f : search.found) found.push_back(f.index);
  heap = std::move(search.found);
}

}  // namespace strata
