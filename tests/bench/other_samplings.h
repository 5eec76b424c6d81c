#pragma once
#include <cstddef>

#include "converter/build/level_order.h"

namespace strata::test {

/// Ways to pick a node's points that levelOrder() is measured against. Both keep `capacity` points, or all where there
/// are fewer, set `order` and `prefix` of the result, and leave the entries of the points' n-tree in `scratch`.

/// Dart throwing: no two points of a prefix are closer than a distance that shrinks by sqrt(2) from round to round,
/// from the side of the n-tree's root on (Cook 1986; McCool and Fiume 1992). Every second round ends a prefix.
LevelOrder poissonOrder(const LocalPoints& points, std::size_t capacity, TreeScratch& scratch);
/// Any points, in an order that looks random.
LevelOrder randomOrder(const LocalPoints& points, std::size_t capacity, TreeScratch& scratch);

/// The side of the root of the points' n-tree, metres.
double rootSideOf(const LocalPoints& points, std::size_t capacity, TreeScratch& scratch);

}  // namespace strata::test
