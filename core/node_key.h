#pragma once
#include <compare>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/box.h"

namespace strata {

/// Address of an octree node: a 1 bit, then 3 bits a level. The root is 1, the deepest level 20.
/// An octant is x*4 + y*2 + z, each 1 in the upper half. Text form: `r`, then one digit a level, as in `r0427`.
struct NodeKey {
  static constexpr int kDeepestLevel = 20;

  std::uint64_t code = 1;

  int level() const;
  int octant() const { return static_cast<int>(code & 7); }
  bool isRoot() const { return code == 1; }
  NodeKey child(int octantIndex) const { return {code << 3 | static_cast<std::uint64_t>(octantIndex)}; }
  NodeKey parent() const { return {code >> 3}; }
  /// True for the key itself too.
  bool isAncestorOf(NodeKey other) const;

  std::string text() const;
  /// Throws Error when `text` is not the text form of a key.
  static NodeKey parse(std::string_view text);

  auto operator<=>(const NodeKey&) const = default;
};

/// The cube of `key` inside the root cube.
Box nodeCube(NodeKey key, const Box& rootCube);

}  // namespace strata
