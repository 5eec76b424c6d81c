#include "io/store/position_codec.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/instruction_sets.h"
#include "core/morton.h"
#include "io/store/bit_packing.h"
#include "io/store/column_codec.h"

namespace strata {
namespace {

/// Bits that an occupied cell costs once its byte is packed.
constexpr std::uint64_t kCellBits = 6;

constexpr Lanes lane(std::uint32_t value, int axis) { return value << (10 * axis); }

/// The last bits in each lane of the children that an occupancy byte names, by ascending octant.
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

/// The number of bits that the lane of an exhausted axis has too many.
int emptyBits(const PayloadHead& head, int axis, int depth) {
  return std::max(0, depth - head.start[axis] - head.bits[axis]);
}

/// Turns the lanes of a cell into the leading bits of the 10 of its points.
class CellLanes {
 public:
  CellLanes(const PayloadHead& head, int depth) {
    for (int a = 0; a < 3; ++a) {
      const int bits = planeBits(head.bits[a], 0), width = bits - octreeBits(head, a, depth);
      const int empty = emptyBits(head, a, depth);
      axis_[a] = {10 * a + empty, 10 * a + width + 10 - bits, 1023u >> empty};
    }
  }
  void place(std::span<Lanes> cells) const {
    const Axis x = axis_[0], y = axis_[1], z = axis_[2];
    for (Lanes& cell : cells)
      cell = (cell >> x.right & x.mask) << x.left | (cell >> y.right & y.mask) << y.left |
             (cell >> z.right & z.mask) << z.left;
  }

 private:
  struct Axis {
    int right, left;
    std::uint32_t mask;
  };
  Axis axis_[3];
};

std::uint64_t loadWord(const void* from) {
  std::uint64_t word;
  std::memcpy(&word, from, sizeof word);
  return word;
}

/// Counts the set bits from bit `first` to bit `end`. 8 bytes behind them must be readable.
std::size_t countBits(const std::uint8_t* bits, std::size_t first, std::size_t end) {
  std::size_t count = 0;
  for (std::size_t at = first; at < end; at += 56) {
    const std::uint64_t word = loadWord(bits + at / 8) >> (at & 7);
    const std::size_t left = end - at < 56 ? end - at : 56;
    count += static_cast<std::size_t>(std::popcount(word & ((std::uint64_t{1} << left) - 1)));
  }
  return count;
}

}  // namespace

LaneFields::LaneFields(const FieldWidths& widths, const int (&left)[3]) : stride_(widths.sum()) {
  int right = 0;
  allTaken_ = true;
  for (int a = 0; a < 3; ++a) {
    const int taken = std::min(widths.axis[a], 10);
    const int dropped = widths.axis[a] - taken;
    axis_[a] = {right + dropped, 10 * a + left[a], (1u << taken) - 1};
    places_ |= axis_[a].mask << axis_[a].left;
    allTaken_ = allTaken_ && dropped == 0;
    right += widths.axis[a];
  }
}

template <class PlaceFields>
inline __attribute__((always_inline)) void LaneFields::readEach(const std::byte* fields, std::size_t first,
                                                                std::span<Lanes> out, PlaceFields&& place) const {
  const auto stride = static_cast<std::size_t>(stride_);
  std::size_t bit = first * stride;
  for (Lanes& lanes : out) {
    lanes = place(loadWord(fields + (bit >> 3)) >> (bit & 7));
    bit += stride;
  }
}

STRATA_TARGET_BMI2 void LaneFields::readByDeposit(const std::byte* fields, std::size_t first,
                                                  std::span<Lanes> out) const {
  const Lanes places = places_;
  readEach(fields, first, out,
           [places](std::uint64_t word) { return depositBits(static_cast<std::uint32_t>(word), places); });
}

void LaneFields::read(const std::byte* fields, std::size_t first, std::span<Lanes> out) const {
  if (stride_ == 0) return std::fill(out.begin(), out.end(), 0u);
  if (allTaken_ && hasBmi2()) return readByDeposit(fields, first, out);
  const Axis x = axis_[0], y = axis_[1], z = axis_[2];
  if (stride_ <= 57)
    return readEach(fields, first, out, [=](std::uint64_t word) {
      return (static_cast<std::uint32_t>(word >> x.right) & x.mask) << x.left |
             (static_cast<std::uint32_t>(word >> y.right) & y.mask) << y.left |
             (static_cast<std::uint32_t>(word >> z.right) & z.mask) << z.left;
    });
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = 0;
    for (const Axis& a : axis_) {
      const std::size_t bit = (first + i) * static_cast<std::size_t>(stride_) + static_cast<std::size_t>(a.right);
      out[i] |= (static_cast<std::uint32_t>(loadWord(fields + bit / 8) >> (bit & 7)) & a.mask) << a.left;
    }
  }
}

LaneFields planeFields(const PayloadHead& head, int plane) {
  const FieldWidths widths = planeWidths(head, plane);
  int left[3];
  for (int a = 0; a < 3; ++a) left[a] = std::max(10 - widths.axis[a], 0);
  return {widths, left};
}

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
  // Neighbouring points that part at depth d are in two cells from there on.
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
  // The order is from the deepest level up, last cell first, which is breadth first when it is reversed.
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

bool OctreeDecoder::open(const PayloadHead& head, std::span<const std::uint32_t> levelEnds,
                         std::span<const std::byte> stored) {
  head_ = head;
  levelEnds_ = levelEnds;
  level_ = levelFirst_ = levelEnd_ = 0;
  std::uint32_t occupancyBytes;
  if (stored.size() < levelEnds.size() + sizeof occupancyBytes) return false;
  depths_ = stored.first(levelEnds.size());
  std::memcpy(&occupancyBytes, stored.data() + depths_.size(), sizeof occupancyBytes);
  rest_ = stored.subspan(depths_.size() + sizeof occupancyBytes);
  const std::size_t points = levelEnds.empty() ? 0 : levelEnds.back();
  if (occupancyBytes > std::uint64_t{kOctreeLevels} * points) return false;
  const std::size_t flagBytes = (points + 7) / 8;
  columns_.resize(occupancyBytes + flagBytes + kBitSlack);
  occupancy_ = std::span(columns_).first(occupancyBytes);
  flags_ = columns_.data() + occupancyBytes;
  return takeColumn(rest_, std::span(columns_).first(occupancyBytes)) &&
         takeColumn(rest_, std::span(columns_).subspan(occupancyBytes, flagBytes));
}

/// Finds the occupied cells of the next level of the level order, down to `depth`. False when they are more than
/// `most`.
bool OctreeDecoder::expandCells(int depth, std::size_t most) {
  cells_.resize(std::max(cells_.size(), most + 8));
  spare_.resize(cells_.size());
  std::size_t count = 1;
  cells_[0] = 0;
  for (int level = 0; level < depth; ++level) {
    if (occupancy_.size() < count) return false;
    std::size_t to = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint8_t byte = occupancy_[i];
      if (byte == 0 || to + kChildren.count[byte] > most) return false;
      const Lanes parent = cells_[i] << 1;
      Lanes* const next = spare_.data() + to;
      for (std::size_t k = 0; k < 8; ++k) next[k] = parent | kChildren.octant[byte][k];
      to += kChildren.count[byte];
    }
    occupancy_ = occupancy_.subspan(count);
    cells_.swap(spare_);
    count = to;
  }
  CellLanes(head_, depth).place(std::span(cells_).first(count));
  // Every cell has a first point, and so has the level.
  const bool begins = (flags_[levelFirst_ / 8] >> (levelFirst_ & 7) & 1) != 0;
  return begins && countBits(flags_, levelFirst_, levelEnd_) == count;
}

bool OctreeDecoder::openLevel(std::size_t first) {
  const auto depth = static_cast<int>(depths_[level_]);
  levelFirst_ = first;
  levelEnd_ = levelEnds_[level_++];
  if (depth > kOctreeLevels || !expandCells(depth, levelEnd_ - first)) return false;
  FieldWidths widths;
  int left[3];
  for (int a = 0; a < 3; ++a) {
    const int bits = planeBits(head_.bits[a], 0);
    widths.axis[a] = bits - octreeBits(head_, a, depth);
    left[a] = 10 - bits;
  }
  fields_ = LaneFields(widths, left);
  const std::size_t bytes = packedBytes(levelEnd_ - first, widths.sum());
  if (bytes > rest_.size()) return false;
  levelFields_ = rest_.data();
  rest_ = rest_.subspan(bytes);
  cell_ = 0;
  return true;
}

bool OctreeDecoder::read(std::size_t first, std::span<Lanes> out) {
  if (first == levelEnd_ && !openLevel(first)) return false;
  fields_.read(levelFields_, first - levelFirst_, out);
  const Lanes* cell = cells_.data() + cell_;
  for (std::size_t i = 0; i < out.size();) {
    const std::size_t at = first + i, end = std::min(out.size(), i + 56);
    for (std::uint64_t flags = loadWord(flags_ + at / 8) >> (at & 7); i < end; ++i, flags >>= 1) {
      cell += flags & 1;
      out[i] |= cell[-1];
    }
  }
  cell_ = static_cast<std::size_t>(cell - cells_.data());
  return true;
}

}  // namespace strata
