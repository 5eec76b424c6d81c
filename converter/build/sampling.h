#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "converter/build/level_order.h"
#include "converter/options.h"

namespace strata {

/// Keeps `capacity` points, or all where there are no more, in an order whose prefixes are subsamples of the node. A
/// function of the points alone. After it `scratch` holds the entries of the points' n-tree.
LevelOrder sampleNode(Sampling sampling, const LocalPoints& points, std::size_t capacity, TreeScratch& scratch);

/// For each of `count` points the place in `order` of the kept point that stands for it: the one of its cell of the
/// n-tree. `scratch` is as sampleNode() left it.
std::vector<std::uint32_t> representedBy(const TreeScratch& scratch, std::size_t count,
                                         std::span<const std::uint32_t> order);

}  // namespace strata
