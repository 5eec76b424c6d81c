#pragma once
#include <atomic>
#include <bitset>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "io/store/store.h"

namespace strata {

/// A vertical slab of the scan: all places within half a width of a line on the ground. World x and y in metres.
struct ProfileSlab {
  std::vector<glm::dvec2> line;  ///< at least two points; a polyline
  double width = 1.0;
};

/// The position of a place in the slab: metres along the line from its beginning, and to the left of it (negative: to
/// the right).
struct SlabPlace {
  double along = 0.0;
  double across = 0.0;
};
/// Found by the nearest point of the line, or the earlier of two that are equally near. Nothing when that point is more
/// than half a width away, or when the place lies beyond an end of the line: the slab ends square.
std::optional<SlabPlace> placeInSlab(const ProfileSlab& slab, const glm::dvec2& place);
double slabLength(const ProfileSlab& slab);
/// Returns false only when no place of the box, whatever its height, is in the slab.
bool mayTouchSlab(const ProfileSlab& slab, const Box& box);

/// A point of a profile, with the values that its source has.
struct ProfilePoint {
  glm::dvec3 position{0.0};  ///< exactly on the store's grid
  double along = 0.0, across = 0.0;
  std::uint32_t colour = 0;  ///< R | G<<8 | B<<16 | 255<<24; 0 where the store has none
  std::uint16_t intensity = 0;
  std::uint8_t classification = 0;
  std::uint8_t depth = 0;  ///< steps down from the root of the octree
  std::uint16_t store = 0;
  std::uint32_t node = 0;   ///< index in the store's hierarchy
  std::uint32_t index = 0;  ///< in the node's level order
};

struct ProfileOptions {
  static constexpr int kDeepest = 64;  ///< steps below the root; slices of a cell are steps too

  int depth = kDeepest;                  ///< nodes further below the root are left out
  std::uint64_t mostPoints = 2'000'000;  ///< never more than these
};

struct Profile {
  ProfileSlab slab;
  std::vector<ProfilePoint> points;  ///< by ascending `along`
  int depth = -1;                    ///< the deepest that was read
  double share = 1.0;                ///< of each node's points at that depth, where the limit cut it
  bool whole = true;                 ///< all points of the slab are there
  std::uint64_t nodesRead = 0;
  std::uint64_t nodesFailed = 0;  ///< that could not be read; the rest is there
  std::string failure;            ///< why, of the first of them
  glm::dvec3 step{0.001};         ///< of the finest grid among the stores
};

/// Reads the slab's points from the stores, not only those that are in memory, from the root downwards, all nodes of a
/// depth together. Where the points of a depth would be more than the limit leaves room for, each of its nodes gives
/// the first 1/2, 1/4, ... of its level order, the largest such share that fits, and nothing is read below: the
/// profile gets thinner everywhere alike. `found` counts on while it reads. Throws nothing; a stop ends it early with
/// what is there.
Profile readProfile(std::span<const std::shared_ptr<const Store>> stores, const ProfileSlab& slab,
                    const ProfileOptions& options, std::stop_token stop, std::atomic<std::uint64_t>* found = nullptr);

/// One line a point of the classes asked for: along, across, x, y, z, intensity, classification, red, green, blue.
std::string profileCsv(const Profile& profile, const std::bitset<256>& classes);

/// "12.3 k points, all there are", "2.00 M points: 25 % of depth 7 and nothing below, which is the limit".
std::string profileText(const Profile& profile);

}  // namespace strata
