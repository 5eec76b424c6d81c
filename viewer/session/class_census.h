#pragma once
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <utility>

#include "core/node_data.h"

namespace strata {

/// What the ASPRS standard calls a class (LAS 1.4 R15, table 17): "ground", "reserved 23", "own 70".
std::string className(std::uint8_t classification);

/// Which classes a scan has, as far as its nodes have been in memory: a store says no more than the least and the
/// largest. The root holds an even subsample of everything, so that common classes are known at once.
class ClassCensus {
 public:
  /// Looks through a node that it has not met. True when a new class was found.
  bool add(std::size_t store, const NodeData& node);
  const std::bitset<256>& present() const { return present_; }

 private:
  std::bitset<256> present_;
  std::set<std::pair<std::size_t, std::pair<std::uint64_t, std::uint32_t>>> met_;  ///< store, key, points
};

}  // namespace strata
