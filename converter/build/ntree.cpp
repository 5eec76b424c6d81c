#include "converter/build/ntree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "converter/build/contour.h"
#include "converter/memory/vector4.h"

namespace strata {
namespace {

constexpr int kDigitBits = 10;
constexpr int kDigits = 3;  // of the radix sort: 30 key bits
constexpr std::size_t kDigitValues = std::size_t{1} << kDigitBits;
constexpr std::uint32_t kThird = 0x15555555;  // 0101... in 30 bits: the aim points, seen from the root

/// The principal axes of a node's points, along which the cells of its n-tree are squares or cubes.
struct PrincipalAxes {
  int levelBits = 3;  ///< log2 n
  int levels = 10;    ///< of a key
  glm::ivec3 middle{0};
  std::array<glm::dvec3, 3> axes;  ///< root sides per local integer
};

PrincipalAxes fitAxes(const LocalPoints& points, const LocalBounds& bounds, NTree& tree) {
  const Anisotropy shape = anisotropy(tree.moments);
  tree.shape = classify(shape);
  PrincipalAxes out;
  out.levelBits = tree.shape == ContourClass::volumetric ? 3 : tree.shape == ContourClass::planar ? 2 : 1;
  out.levels = out.levelBits == 3 ? 10 : out.levelBits == 2 ? 15 : 24;
  out.middle = bounds.low + (bounds.high - bounds.low) / 2;
  const glm::dvec3 half = (glm::dvec3(bounds.high - bounds.low) * 0.5 + 1.0) * points.step;
  for (std::size_t k = 0; k < static_cast<std::size_t>(out.levelBits); ++k)
    tree.rootSide = std::max(tree.rootSide, 2.0 * glm::dot(glm::abs(shape.axes[k]), half));
  for (std::size_t k = 0; k < 3; ++k) out.axes[k] = shape.axes[k] * points.step / tree.rootSide;
  return out;
}

/// Puts one zero bit after each of the low 15 bits.
Uint4 spreadBy1(Uint4 v) {
  v = (v | v << 8) & 0x00ff00ff;
  v = (v | v << 4) & 0x0f0f0f0f;
  v = (v | v << 2) & 0x33333333;
  return (v | v << 1) & 0x55555555;
}

/// Puts two zero bits after each of the low 10 bits.
Uint4 spreadBy2(Uint4 v) {
  v = (v | v << 16) & 0x030000ff;
  v = (v | v << 8) & 0x0300f00f;
  v = (v | v << 4) & 0x030c30c3;
  return (v | v << 2) & 0x09249249;
}

template <int kLevelBits>
[[gnu::always_inline]] inline Uint4 interleave(const Uint4 (&cell)[3]) {
  if constexpr (kLevelBits == 1) return cell[0];
  if constexpr (kLevelBits == 2) return spreadBy1(cell[0]) << 1 | spreadBy1(cell[1]);
  return spreadBy2(cell[0]) << 2 | spreadBy2(cell[1]) << 1 | spreadBy2(cell[2]);
}

std::uint32_t interleave(int levelBits, const std::uint32_t (&cell)[3]) {
  const Uint4 cells[3] = {Uint4{} + cell[0], Uint4{} + cell[1], Uint4{} + cell[2]};
  return levelBits == 1 ? cell[0] : levelBits == 2 ? interleave<2>(cells)[0] : interleave<3>(cells)[0];
}

/// Makes the keys of four points, given their positions from the middle.
template <int kLevelBits>
class KeyMaker {
 public:
  explicit KeyMaker(const PrincipalAxes& principal)
      : most_(std::ldexp(1.0f, principal.levels) - 1.0f), aim_(kThird >> (30 - principal.levels)) {
    for (std::size_t k = 0; k < kLevelBits; ++k)
      for (int i = 0; i < 3; ++i) axes_[k][i] = static_cast<float>(std::ldexp(principal.axes[k][i], principal.levels));
    half_ = std::ldexp(0.5f, principal.levels);
  }
  Uint4 operator()(const Float4& x, const Float4& y, const Float4& z) const {
    Uint4 cell[3] = {};
    for (int k = 0; k < kLevelBits; ++k) {
      Float4 along = x * axes_[k][0] + y * axes_[k][1] + z * axes_[k][2] + half_;
      along = along > 0.0f ? along : Float4{};
      along = along < most_ ? along : Float4{} + most_;
      cell[k] = reinterpret_cast<Uint4>(__builtin_convertvector(along, Int4)) ^ aim_;
    }
    return interleave<kLevelBits>(cell);
  }

 private:
  float axes_[3][3] = {};
  float half_ = 0.0f;
  const float most_;
  const std::uint32_t aim_;
};

template <int kLevelBits>
void makeKeys(const LocalPoints& points, const PrincipalAxes& principal, std::uint64_t* entries) {
  const KeyMaker<kLevelBits> keys(principal);
  const std::size_t count = points.count();
  for (std::size_t i = 0; i < count; i += 4) {
    Int4 at[3] = {};
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t* from = points.axis[axis].data() + i;
      if (i + 4 <= count)
        at[axis] = loadInts(from);
      else
        std::memcpy(&at[axis], from, (count - i) * sizeof *from);
    }
    const Uint4 key = keys(toFloats(at[0] - principal.middle.x), toFloats(at[1] - principal.middle.y),
                           toFloats(at[2] - principal.middle.z));
    for (std::size_t lane = 0; lane < 4 && i + lane < count; ++lane)
      entries[i + lane] = static_cast<std::uint64_t>(key[lane]) << 32 | (i + lane);
  }
}

/// Sorts by key, keeping the order of equal keys; the result is in `entries`.
void sortEntries(std::size_t count, Buffer<std::uint64_t>& entries, Buffer<std::uint64_t>& spare) {
  std::array<std::array<std::uint32_t, kDigitValues>, kDigits> starts{};
  const auto digit = [](std::uint64_t entry, int d) {
    return static_cast<std::size_t>(entry >> (32 + kDigitBits * d)) & (kDigitValues - 1);
  };
  for (std::size_t i = 0; i < count; ++i)
    for (int d = 0; d < kDigits; ++d) ++starts[static_cast<std::size_t>(d)][digit(entries[i], d)];
  for (int d = 0; d < kDigits; ++d) {
    auto& start = starts[static_cast<std::size_t>(d)];
    if (start[digit(entries[0], d)] == count) continue;
    std::uint32_t sum = 0;
    for (std::uint32_t& s : start) {
      const std::uint32_t here = s;
      s = sum;
      sum += here;
    }
    for (std::size_t i = 0; i < count; ++i) spare[start[digit(entries[i], d)]++] = entries[i];
    entries.swap(spare);
  }
}

/// The pass that a new point belongs to, by its own digit and the digit above (of lines, two above). Points far from
/// the cell's representative come first, and of these those in every second or fourth cell.
std::array<std::uint8_t, 64> passTable(int levelBits) {
  constexpr std::uint8_t kLine[8] = {0, 0, 0, 2, 0, 1, 0, 3};
  constexpr std::uint8_t kPlaneChild[4] = {0, 1, 2, 0}, kPlaneParent[4] = {0, 2, 3, 1};
  constexpr std::uint8_t kVolumeChild[8] = {0, 4, 5, 1, 6, 2, 3, 0};
  std::array<std::uint8_t, 64> table{};
  for (unsigned i = 0; i < 64; ++i) {
    if (levelBits == 1) table[i] = kLine[i % 8];
    if (levelBits == 2) table[i] = static_cast<std::uint8_t>(4 * kPlaneChild[i % 4] + kPlaneParent[i / 4 % 4]);
    if (levelBits == 3) table[i] = static_cast<std::uint8_t>(2 * kVolumeChild[i % 8] + std::popcount(i / 8) % 2);
  }
  return table;
}

/// Points that cannot be told apart are spread over 16 passes, each in the middle of the widest gap.
std::uint16_t rankBeyond(std::size_t i) {
  constexpr std::uint8_t kPasses[16] = {0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15};
  return static_cast<std::uint16_t>(NTree::kBeyond * NTree::kPasses + kPasses[i % 16]);
}

/// Finds the rank of a point from the highest bit in which its key differs from the key before.
struct Ranker {
  explicit Ranker(const PrincipalAxes& principal, int firstLevel = 0) : table(passTable(principal.levelBits)) {
    mask = principal.levelBits == 1 ? 7 : principal.levelBits == 2 ? 15 : 63;
    for (int bit = 0; bit < 32; ++bit) {
      const int digit = bit / principal.levelBits;
      shift[static_cast<std::size_t>(bit)] = static_cast<std::uint8_t>(digit * principal.levelBits);
      base[static_cast<std::size_t>(bit)] =
          static_cast<std::uint16_t>((firstLevel + principal.levels - digit) * NTree::kPasses);
    }
  }
  std::uint16_t operator()(std::uint32_t key, std::uint32_t different) const {
    const auto bit = static_cast<std::size_t>(31 - std::countl_zero(different));
    return static_cast<std::uint16_t>(base[bit] + table[key >> shift[bit] & mask]);
  }
  std::array<std::uint8_t, 64> table;
  std::array<std::uint8_t, 32> shift{};
  std::array<std::uint16_t, 32> base{};
  std::uint32_t mask;
};

/// Ranks all entries, and returns how many points share their key with the one before.
std::size_t rankEntries(std::size_t count, const PrincipalAxes& principal, TreeScratch& scratch) {
  const Ranker ranker(principal);
  std::size_t alike = 0;
  scratch.ranks[0] = 0;
  auto before = static_cast<std::uint32_t>(scratch.entries[0] >> 32);
  for (std::size_t i = 1; i < count; ++i) {
    const auto key = static_cast<std::uint32_t>(scratch.entries[i] >> 32);
    if (key == before) {
      ++alike;
      scratch.ranks[i] = rankBeyond(i);
    } else {
      scratch.ranks[i] = ranker(key, key ^ before);
    }
    before = key;
  }
  return alike;
}

/// Adds as many levels again for the points whose keys are the same so far, and sorts `entries` by the longer key.
void deepen(const LocalPoints& points, const PrincipalAxes& principal, TreeScratch& scratch) {
  const double cells = std::ldexp(1.0, 2 * principal.levels);
  const std::uint32_t inside = (1u << principal.levels) - 1;
  const std::uint32_t aim = kThird >> (30 - 2 * principal.levels) & inside;
  const auto finerKey = [&](std::uint64_t entry) {
    const auto p = static_cast<std::uint32_t>(entry);
    const glm::dvec3 d(points.axis[0][p] - principal.middle.x, points.axis[1][p] - principal.middle.y,
                       points.axis[2][p] - principal.middle.z);
    std::uint32_t cell[3];
    for (std::size_t k = 0; k < 3; ++k)
      cell[k] = (static_cast<std::uint32_t>((glm::dot(d, principal.axes[k]) + 0.5) * cells) & inside) ^ aim;
    return interleave(principal.levelBits, cell);
  };
  const Ranker ranker(principal, principal.levels);
  const std::size_t count = points.count();
  std::vector<std::uint64_t> run;
  for (std::size_t first = 0; first < count;) {
    std::size_t end = first + 1;
    const std::uint64_t key = scratch.entries[first] >> 32;
    while (end < count && scratch.entries[end] >> 32 == key) ++end;
    if (end - first > 1) {
      run.clear();
      for (std::size_t i = first; i < end; ++i)
        run.push_back(static_cast<std::uint64_t>(finerKey(scratch.entries[i])) << 32 |
                      static_cast<std::uint32_t>(scratch.entries[i]));
      std::sort(run.begin(), run.end());
      for (std::size_t i = 0; i < run.size(); ++i) {
        scratch.entries[first + i] = key << 32 | static_cast<std::uint32_t>(run[i]);
        if (i == 0) continue;
        const auto finer = static_cast<std::uint32_t>(run[i] >> 32);
        const auto different = finer ^ static_cast<std::uint32_t>(run[i - 1] >> 32);
        scratch.ranks[first + i] = different == 0 ? rankBeyond(i) : ranker(finer, different);
      }
    }
    first = end;
  }
}

}  // namespace

NTree buildTree(const LocalPoints& points, std::size_t wanted, TreeScratch& scratch) {
  const std::size_t count = points.count();
  scratch.entries.room(count);
  scratch.spare.room(count);
  scratch.ranks.room(count);
  const LocalBounds bounds = boundsOf(points);
  NTree tree;
  tree.moments = momentsOf(points, bounds);
  const PrincipalAxes principal = fitAxes(points, bounds, tree);
  if (principal.levelBits == 3) makeKeys<3>(points, principal, scratch.entries.data());
  if (principal.levelBits == 2) makeKeys<2>(points, principal, scratch.entries.data());
  if (principal.levelBits == 1) makeKeys<1>(points, principal, scratch.entries.data());
  sortEntries(count, scratch.entries, scratch.spare);
  const std::size_t alike = rankEntries(count, principal, scratch);
  wanted = std::min(wanted, count);
  if (principal.levelBits > 1 && count - alike < wanted - wanted / 64) deepen(points, principal, scratch);
  tree.entries = scratch.entries.room(count);
  tree.ranks = scratch.ranks.room(count);
  return tree;
}

}  // namespace strata
