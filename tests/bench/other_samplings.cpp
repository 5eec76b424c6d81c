#include "tests/bench/other_samplings.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/random.h"
#include "io/store/store.h"

namespace strata::test {
namespace {

/// A Poisson-disk sample tries so many candidates per kept point: more of them leave fewer holes.
constexpr std::size_t kCandidates = 8;

/// The first `wanted` points in an order that looks random, or all.
std::vector<std::uint32_t> shuffled(const LocalPoints& points, std::size_t wanted) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> hashes(points.count());
  for (std::size_t i = 0; i < hashes.size(); ++i) {
    std::uint64_t hash = i;
    for (const auto& axis : points.axis) hash = splitMix64(hash ^ static_cast<std::uint64_t>(axis[i]));
    hashes[i] = {hash, static_cast<std::uint32_t>(i)};
  }
  wanted = std::min(wanted, hashes.size());
  std::nth_element(hashes.begin(), hashes.begin() + static_cast<std::ptrdiff_t>(wanted), hashes.end());
  hashes.resize(wanted);
  std::sort(hashes.begin(), hashes.end());
  std::vector<std::uint32_t> out(wanted);
  for (std::size_t i = 0; i < wanted; ++i) out[i] = hashes[i].second;
  return out;
}

/// Kept points in cubes of one side, hashed.
class CubeGrid {
 public:
  CubeGrid(const LocalPoints& points, std::size_t most, double side)
      : points_(points),
        heads_(std::size_t{2} << std::bit_width(most), kNone),
        next_(points.count(), kNone),
        side_(side) {}

  glm::dvec3 position(std::uint32_t p) const {
    return points_.step * glm::dvec3(points_.axis[0][p], points_.axis[1][p], points_.axis[2][p]);
  }
  void add(std::uint32_t p) {
    const glm::i64vec3 cube = glm::floor(position(p) / side_);
    std::uint32_t& head = heads_[slot(cube)];
    next_[p] = head;
    head = p;
  }
  bool hasWithinSide(std::uint32_t p) const {
    const glm::dvec3 at = position(p);
    const glm::i64vec3 low = glm::floor(at / side_ - 1.0), high = low + std::int64_t{2};
    for (std::int64_t x = low.x; x <= high.x; ++x)
      for (std::int64_t y = low.y; y <= high.y; ++y)
        for (std::int64_t z = low.z; z <= high.z; ++z)
          for (std::uint32_t q = heads_[slot({x, y, z})]; q != kNone; q = next_[q]) {
            const glm::dvec3 apart = position(q) - at;
            if (glm::dot(apart, apart) < side_ * side_) return true;
          }
    return false;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  std::size_t slot(const glm::i64vec3& cube) const {
    const auto hash = static_cast<std::uint64_t>(cube.x) << 42 ^ static_cast<std::uint64_t>(cube.y) << 21 ^
                      static_cast<std::uint64_t>(cube.z);
    return splitMix64(hash) & (heads_.size() - 1);
  }

  const LocalPoints& points_;
  std::vector<std::uint32_t> heads_, next_;
  const double side_;
};

/// Ends the last prefix.
LevelOrder finished(LevelOrder out) {
  const auto kept = static_cast<std::uint32_t>(out.order.size());
  if (out.prefix.empty() || out.prefix.back() != kept) out.prefix.push_back(kept);
  return out;
}

}  // namespace

double rootSideOf(const LocalPoints& points, std::size_t capacity, TreeScratch& scratch) {
  return points.count() == 0 ? 0.0 : buildTree(points, capacity, scratch).rootSide;
}

LevelOrder poissonOrder(const LocalPoints& points, std::size_t capacity, TreeScratch& scratch) {
  LevelOrder out;
  const double rootSide = rootSideOf(points, capacity, scratch);
  capacity = std::min(capacity, points.count());
  std::vector<std::uint32_t> left = shuffled(points, std::max(capacity, capacity * kCandidates));
  const double finest = 0.5 * std::min({points.step.x, points.step.y, points.step.z});
  double distance = rootSide;
  for (int round = 0; out.order.size() < capacity; ++round, distance *= std::sqrt(0.5)) {
    // What is nearer than any two coordinates can be is a copy: they all come.
    const bool copies = distance < finest;
    CubeGrid grid(points, 2 * (out.order.size() + 16), distance);
    for (const std::uint32_t p : out.order) grid.add(p);
    const std::size_t tried = copies ? left.size() : std::min(left.size(), kCandidates * (out.order.size() + 16));
    std::size_t to = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const std::uint32_t p = left[i];
      if (i < tried && out.order.size() < capacity && (copies || !grid.hasWithinSide(p))) {
        grid.add(p);
        out.order.push_back(p);
      } else {
        left[to++] = p;
      }
    }
    left.resize(to);
    if (round % 2 == 0 && out.prefix.size() + 1 < NodeRecord::kMaxPrefixes)
      out.prefix.push_back(static_cast<std::uint32_t>(out.order.size()));
  }
  return finished(std::move(out));
}

LevelOrder randomOrder(const LocalPoints& points, std::size_t capacity, TreeScratch& scratch) {
  LevelOrder out;
  rootSideOf(points, capacity, scratch);  // for the n-tree
  out.order = shuffled(points, capacity);
  for (std::size_t size = 1; size < out.order.size(); size *= 4) out.prefix.push_back(static_cast<std::uint32_t>(size));
  return finished(std::move(out));
}

}  // namespace strata::test
