#include "io/position_codec.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/morton.h"
#include "io/bit_packing.h"
#include "io/column_codec.h"

namespace strata {
namespace {

/// What an occupied cell costs in bits, its byte packed.
constexpr std::uint64_t kCellBits = 6;

constexpr Lanes lane(std::uint32_t value, int axis) { return value << (10 * axis); }

/// The children that an occupancy byte names, by ascending octant: their last bits in each lane.
struct Children {
  Lanes octant[256][8];
  std::uint8_t count[256];
};
constexpr Children makeChildren() {
  Children table{};
  for (unsigned byte = 0; byte < 256; ++byte)
    for (unsigned octant = 0; octant < 8; ++octant)
      if (byte >> octant & 1)
        table.octant[byte][table.count[byte]++] = lane(octant >> 2, 0) | lane(octant >> 1 & 1, 1) | lane(octant & 1, 2);
  return table;
}
constexpr Children kChildren = makeChildren();

/// Bits that an exhausted axis has too many in its lane.
int emptyBits(const PayloadHead& head, int axis, int depth) {
  return std::max(0, depth - head.start[axis] - head.bits[axis]);
}

/// How the lanes of a cell and the fields of a point become 10 bits an axis.
struct Assembly {
  struct Axis {
    int cellRight = 0, cellLeft = 0, fieldRight = 0, fieldLeft = 0;
    std::uint32_t fieldMask = 0;
  };
  Axis axis[3];
  int sum = 0;

  Assembly(const PayloadHead& head, int depth) {
    for (int a = 0; a < 3; ++a) {
      const int bits = planeBits(head.bits[a], 0);
      const int width = bits - octreeBits(head, a, depth);
      axis[a] = {10 * a + emptyBits(head, a, depth), width + 10 - bits, sum, 10 - bits, (1u << width) - 1};
      sum += width;
    }
  }
  /// A cell's part of its points.
  Lanes high(Lanes cell) const {
    Lanes out = 0;
    for (int a = 0; a < 3; ++a)
      out |= lane((cell >> axis[a].cellRight & (1023u >> (axis[a].cellRight - 10 * a))) << axis[a].cellLeft, a);
    return out;
  }
  Lanes low(std::uint32_t fields) const {
    return lane((fields >> axis[0].fieldRight & axis[0].fieldMask) << axis[0].fieldLeft, 0) |
           lane((fields >> axis[1].fieldRight & axis[1].fieldMask) << axis[1].fieldLeft, 1) |
           lane((fields >> axis[2].fieldRight & axis[2].fieldMask) << axis[2].fieldLeft, 2);
  }
};

/// Expands the occupied cells of one level down to `depth`; moves `occupancy` on. False when more than `most` come out.
bool expandCells(std::span<const std::uint8_t>& occupancy, int depth, std::size_t most, std::vector<Lanes>& cells,
                 std::vector<Lanes>& next) {
  cells.resize(most + 8);
  next.resize(most + 8);
  std::size_t count = 1;
  cells[0] = 0;
  for (int level = 0; level < depth; ++level) {
    if (occupancy.size() < count) return false;
    std::size_t to = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint8_t byte = occupancy[i];
      if (byte == 0 || to + kChildren.count[byte] > most) return false;
      const Lanes parent = cells[i] << 1;
      for (std::size_t k = 0; k < 8; ++k) next[to + k] = parent | kChildren.octant[byte][k];
      to += kChildren.count[byte];
    }
    occupancy = occupancy.subspan(count);
    cells.swap(next);
    count = to;
  }
  cells.resize(count);
  return true;
}

/// Puts cells, flags and fields of one level together.
bool assembleLevel(const Assembly& assembly, std::vector<Lanes>& cells, const std::vector<std::uint8_t>& flags,
                   std::size_t firstPoint, const std::byte* fields, std::span<Lanes> out) {
  for (Lanes& cell : cells) cell = assembly.high(cell);
  BitReader reader(fields);
  std::size_t cell = ~std::size_t{0};
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t at = firstPoint + i;
    cell += flags[at >> 3] >> (at & 7) & 1u;
    if (cell >= cells.size()) return false;
    out[i] = cells[cell] | assembly.low(static_cast<std::uint32_t>(reader.get(assembly.sum)));
  }
  return cell + 1 == cells.size();
}

}  // namespace

int octreeBits(const PayloadHead& head, int axis, int depth) {
  return std::clamp(depth - head.start[axis], 0, static_cast<int>(head.bits[axis]));
}

std::uint32_t octreeKey(const PayloadHead& head, const std::uint64_t (&offset)[3]) {
  std::uint64_t leading[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int below = head.bits[axis] + head.start[axis] - kOctreeLevels;
    leading[axis] = below >= 0 ? offset[axis] >> below : offset[axis] << -below;
  }
  return static_cast<std::uint32_t>(mortonCode(leading[0], leading[1], leading[2]));
}

void OctreeEncoder::clear() {
  depths_.clear();
  occupancy_.clear();
  flags_.clear();
  points_ = 0;
}

int OctreeEncoder::addLevel(const PayloadHead& head, std::span<const std::uint32_t> keys) {
  // Neighbours that part at depth d are two cells from there on.
  std::uint64_t parts[kOctreeLevels + 1] = {};
  for (std::size_t i = 1; i < keys.size(); ++i) {
    const std::uint32_t different = keys[i] ^ keys[i - 1];
    if (different != 0) ++parts[kOctreeLevels - (31 - std::countl_zero(different)) / 3];
  }
  int depth = 0;
  for (std::uint64_t cells = 1; depth < kOctreeLevels; ++depth) {
    std::uint64_t saved = 0;
    for (int axis = 0; axis < 3; ++axis)
      saved += static_cast<std::uint64_t>(octreeBits(head, axis, depth + 1) - octreeBits(head, axis, depth));
    if (depth > 0) cells += parts[depth];
    if (kCellBits * cells >= saved * keys.size()) break;
  }
  describe(keys, depth);
  return depth;
}

void OctreeEncoder::describe(std::span<const std::uint32_t> keys, int depth) {
  const int shift = 3 * (kOctreeLevels - depth);
  flags_.resize((points_ + keys.size() + 7) / 8);
  cells_.clear();
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const std::uint32_t cell = keys[i] >> shift;
    const bool begins = i == 0 || cell != keys[i - 1] >> shift;
    const std::uint64_t at = points_ + i;
    flags_[at >> 3] = static_cast<std::uint8_t>(flags_[at >> 3] | static_cast<unsigned>(begins) << (at & 7));
    if (begins) cells_.push_back(cell);
  }
  points_ += keys.size();
  depths_.push_back(static_cast<std::uint8_t>(depth));
  // From the deepest level up, last cell first; reversed, that is breadth first.
  reversed_.clear();
  std::reverse(cells_.begin(), cells_.end());
  for (int level = depth; level > 0; --level) {
    std::size_t to = 0;
    for (std::size_t i = 0; i < cells_.size();) {
      const std::uint32_t parent = cells_[i] >> 3;
      unsigned byte = 0;
      for (; i < cells_.size() && cells_[i] >> 3 == parent; ++i) byte |= 1u << (cells_[i] & 7);
      reversed_.push_back(static_cast<std::uint8_t>(byte));
      cells_[to++] = parent;
    }
    cells_.resize(to);
  }
  occupancy_.insert(occupancy_.end(), reversed_.rbegin(), reversed_.rend());
}

void OctreeEncoder::append(std::vector<std::byte>& out) {
  const auto depths = std::as_bytes(std::span(depths_));
  out.insert(out.end(), depths.begin(), depths.end());
  const auto bytes = static_cast<std::uint32_t>(occupancy_.size());
  out.resize(out.size() + sizeof bytes);
  std::memcpy(out.data() + out.size() - sizeof bytes, &bytes, sizeof bytes);
  appendColumn(occupancy_, out);
  appendColumn(flags_, out);
}

bool decodeOctree(const PayloadHead& head, std::span<const std::uint32_t> levelEnds, std::span<const std::byte> stored,
                  std::span<Lanes> out) {
  std::uint32_t occupancyBytes;
  if (stored.size() < levelEnds.size() + sizeof occupancyBytes) return false;
  const std::span<const std::byte> depths = stored.first(levelEnds.size());
  std::memcpy(&occupancyBytes, stored.data() + depths.size(), sizeof occupancyBytes);
  stored = stored.subspan(depths.size() + sizeof occupancyBytes);
  if (occupancyBytes > std::uint64_t{kOctreeLevels} * out.size()) return false;
  std::vector<std::uint8_t> occupancy(occupancyBytes), flags((out.size() + 7) / 8);
  if (!takeColumn(stored, occupancy) || !takeColumn(stored, flags)) return false;

  std::vector<Lanes> cells, spare;
  std::span<const std::uint8_t> rest(occupancy);
  std::size_t first = 0;
  for (std::size_t level = 0; level < levelEnds.size(); ++level) {
    const std::size_t count = levelEnds[level] - first;
    const auto depth = static_cast<int>(depths[level]);
    if (depth > kOctreeLevels || !expandCells(rest, depth, count, cells, spare)) return false;
    const Assembly assembly(head, depth);
    const std::size_t bytes = packedBytes(count, assembly.sum);
    if (bytes > stored.size()) return false;
    if (!assembleLevel(assembly, cells, flags, first, stored.data(), out.subspan(first, count))) return false;
    stored = stored.subspan(bytes);
    first += count;
  }
  return rest.empty() && stored.empty();
}

bool decodePacked(const PayloadHead& head, std::span<const std::byte> stored, std::span<Lanes> out) {
  const Assembly assembly(head, 0);
  if (stored.size() != packedBytes(out.size(), assembly.sum)) return false;
  BitReader reader(stored.data());
  for (Lanes& point : out) point = assembly.low(static_cast<std::uint32_t>(reader.get(assembly.sum)));
  return true;
}

}  // namespace strata
