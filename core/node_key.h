#pragma once
#include <compare>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/box.h"

namespace strata {

/// The address of a cell of the octree: a 1 bit, then 3 bits for each level; the root is 1. The bits of a level are the
/// octant x*4 + y*2 + z, where each of x, y and z is 1 in the upper half. As text: `r`, then a digit for each level, as
/// in `r0427`.
struct NodeKey {
  static constexpr int kDeepestLevel = 20;

  std::uint64_t code = 1;

  int level() const;
  int octant() const { return static_cast<int>(code & 7); }
  bool isRoot() const { return code == 1; }
  NodeKey child(int octantIndex) const { return {code << 3 | static_cast<std::uint64_t>(octantIndex)}; }
  NodeKey parent() const { return {code >> 3}; }
  /// True for the key itself as well.
  bool isAncestorOf(NodeKey other) const;

  std::string text() const;
  /// The reverse of text(). Throws Error when `text` is not a key.
  static NodeKey parse(std::string_view text);

  auto operator<=>(const NodeKey&) const = default;
};

/// The cube of the cell `key`, inside the cube of the root.
Box nodeCube(NodeKey key, const Box& rootCube);

}  // namespace strata
