#pragma once
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace strata {

/// A kd-tree over distinct points that finds the nearest neighbours of one of them. They depend on the points within
/// reach alone, not on the shape of the tree: of points equally far the one with the smaller x, then y, then z counts
/// as nearer. Immutable after construction.
class NearestPoints {
 public:
  /// `points` must be distinct, sorted by x, y, z, and outlive the tree.
  explicit NearestPoints(const std::vector<glm::dvec3>& points);

  /// Replaces `found` by the indices of at most `count` points within `reach` of point `index`, itself included,
  /// from the nearest on.
  void find(std::uint32_t index, std::size_t count, double reach, std::vector<std::uint32_t>& found) const;

  /// The indices of the points in an order in which consecutive points are mostly near each other, so that searches in
  /// this order find the tree in the processor's caches.
  const std::vector<std::uint32_t>& order() const { return order_; }

 private:
  struct Node {
    double split = 0.0;                ///< coordinate between the two sides
    std::uint32_t begin = 0, end = 0;  ///< range of order_
    std::uint32_t right = 0;           ///< index of the upper side; the lower one follows its parent. 0 = a leaf
    std::uint32_t axis = 0;
  };
  struct Search;

  void build(std::uint32_t begin, std::uint32_t end);
  void visit(std::uint32_t node, glm::dvec3 beyond, Search& search) const;

  const std::vector<glm::dvec3>& points_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace strata
