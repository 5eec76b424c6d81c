#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "converter/level_order.h"

namespace strata {

/// How a node's points are picked and ordered. All but `ntree` are there to be measured against it.
enum class Sampling : std::uint8_t {
  ntree,    ///< levelOrder()
  poisson,  ///< no two points of a prefix closer than a distance that shrinks from level to level, by random trial
  random    ///< any
};
const char* samplingName(Sampling sampling);

/// Which colour the points of nodes with children are drawn in.
enum class LodColour : std::uint8_t {
  first,   ///< their own
  average  ///< the mean of the points that they stand for
};

/// Keeps `capacity` points, or all where there are no more, in an order whose prefixes are subsamples of the node. A
/// function of the points alone. After it `scratch` holds the entries of the points' n-tree.
LevelOrder sampleNode(Sampling sampling, const LocalPoints& points, std::size_t capacity, TreeScratch& scratch);

/// For each of `count` points the place in `order` of the kept point that stands for it: the one of its cell of the
/// n-tree. `scratch` is as sampleNode() left it.
std::vector<std::uint32_t> representedBy(const TreeScratch& scratch, std::size_t count,
                                         std::span<const std::uint32_t> order);

}  // namespace strata
