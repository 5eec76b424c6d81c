#include "converter/build/sampling.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "io/store/store.h"

namespace strata {
namespace {

/// Candidates of a Poisson-disk sample a kept point: more of them leave fewer holes.
constexpr std::size_t kCandidates = 8;

/// splitmix64 of Steele, Lea and Flood 2014.
std::uint64_t mixed(std::uint64_t v) {
  v += 0x9e3779b97f4a7c15;
  v = (v ^ v >> 30) * 0xbf58476d1ce4e5b9;
  v = (v ^ v >> 27) * 0x94d049bb133111eb;
  return v ^ v >> 31;
}

/// The first `wanted` points in an order that looks random, or all.
std::vector<std::uint32_t> shuffled(const LocalPoints& points, std::size_t wanted) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> hashes(points.count());
  for (std::size_t i = 0; i < hashes.size(); ++i) {
    std::uint64_t hash = i;
    for (const auto& axis : points.axis) hash = mixed(hash ^ static_cast<std::uint64_t>(axis[i]));
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
    return mixed(hash) & (heads_.size() - 1);
  }

  const LocalPoints& points_;
  std::vector<std::uint32_t> heads_, next_;
  const double side_;
};

/// Dart throwing with a distance that shrinks by sqrt(2) from round to round (Cook 1986; McCool and Fiume 1992).
void poissonOrder(const LocalPoints& points, std::size_t capacity, double rootSide, LevelOrder& out) {
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
}

void randomOrder(const LocalPoints& points, std::size_t capacity, LevelOrder& out) {
  out.order = shuffled(points, capacity);
  for (std::size_t size = 1; size < out.order.size(); size *= 4) out.prefix.push_back(static_cast<std::uint32_t>(size));
}

}  // namespace

const char* samplingName(Sampling sampling) {
  switch (sampling) {
    case Sampling::ntree:
      return "ntree";
    case Sampling::poisson:
      return "poisson";
    case Sampling::random:
      return "random";
  }
  return "";
}

LevelOrder sampleNode(Sampling sampling, const LocalPoints& points, std::size_t capacity, TreeScratch& scratch) {
  LevelOrder levels = levelOrder(points, capacity, scratch);
  if (sampling == Sampling::ntree || points.count() == 0) return levels;
  LevelOrder other;
  other.spacing = levels.spacing;
  other.moments = levels.moments;
  other.rootSide = levels.rootSide;
  if (sampling == Sampling::poisson)
    poissonOrder(points, capacity, levels.rootSide, other);
  else
    randomOrder(points, capacity, other);
  const auto kept = static_cast<std::uint32_t>(other.order.size());
  if (other.prefix.empty() || other.prefix.back() != kept) other.prefix.push_back(kept);
  return other;
}

std::vector<std::uint32_t> representedBy(const TreeScratch& scratch, std::size_t count,
                                         std::span<const std::uint32_t> order) {
  constexpr std::uint32_t kNone = 0xffffffff;
  std::vector<std::uint32_t> by(count, kNone);
  for (std::size_t place = 0; place < order.size(); ++place) by[order[place]] = static_cast<std::uint32_t>(place);
  const auto point = [&](std::size_t entry) { return static_cast<std::uint32_t>(scratch.entries[entry]); };
  std::uint32_t current = kNone;
  for (std::size_t i = 0; i < count && current == kNone; ++i) current = by[point(i)];
  for (std::size_t i = 0; i < count; ++i) {
    if (by[point(i)] != kNone) current = by[point(i)];
    by[point(i)] = current;
  }
  return by;
}

}  // namespace strata
