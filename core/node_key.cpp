#include "core/node_key.h"

#include <bit>

#include "core/error.h"

namespace strata {

int NodeKey::level() const { return (static_cast<int>(std::bit_width(code)) - 1) / 3; }

bool NodeKey::isAncestorOf(NodeKey other) const {
  const int levels = other.level() - level();
  return levels >= 0 && (other.code >> (3 * levels)) == code;
}

std::string NodeKey::text() const {
  std::string out = "r";
  for (int l = level() - 1; l >= 0; --l) out += static_cast<char>('0' + ((code >> (3 * l)) & 7));
  return out;
}

NodeKey NodeKey::parse(std::string_view text) {
  const std::string shown(text);
  if (text.empty() || text[0] != 'r' || text.size() > 1 + static_cast<std::size_t>(kDeepestLevel))
    throw Error("node key '" + shown + "' is not r followed by at most 20 octants");
  NodeKey key;
  for (const char c : text.substr(1)) {
    if (c < '0' || c > '7') throw Error("node key '" + shown + "' has an octant outside 0 to 7");
    key = key.child(c - '0');
  }
  return key;
}

Box nodeCube(NodeKey key, const Box& rootCube) {
  const int level = key.level();
  std::uint64_t cell[3] = {0, 0, 0};
  for (int l = level - 1; l >= 0; --l) {
    const std::uint64_t octant = (key.code >> (3 * l)) & 7;
    cell[0] = cell[0] << 1 | (octant >> 2 & 1);
    cell[1] = cell[1] << 1 | (octant >> 1 & 1);
    cell[2] = cell[2] << 1 | (octant & 1);
  }
  const glm::dvec3 size = rootCube.size() / static_cast<double>(std::uint64_t{1} << level);
  Box cube;
  cube.min = rootCube.min + size * glm::dvec3(cell[0], cell[1], cell[2]);
  cube.max = cube.min + size;
  return cube;
}

}  // namespace strata
