#pragma once
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <utility>

#include "core/node_data.h"

namespace strata {

/// The name of a class in the ASPRS standard (LAS 1.4 R15, table 17): "ground", "reserved 23", "own 70".
std::string className(std::uint8_t classification);

/// Collects the classes of a scan from the nodes that have been in memory, because a store records only the lowest and
/// the highest class. The root holds an even subsample of everything, so common classes are known at once.
class ClassCensus {
 public:
  /// Looks through a node, unless it has seen that node before. Returns true when it found a new class.
  bool add(std::size_t store, const NodeData& node);
  const std::bitset<256>& present() const { return present_; }

 private:
  std::bitset<256> present_;
  std::set<std::pair<std::size_t, std::pair<std::uint64_t, std::uint32_t>>> met_;  ///< store, key, points
};

}  // namespace strata
