#include "viewer/tools/profile.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <tuple>

#include "core/readable.h"
#include "core/scalar.h"
#include "io/store/node_codec.h"
#include "viewer/tools/pick.h"

namespace strata {
namespace {

/// What of a store's records a profile keeps.
struct RecordFields {
  explicit RecordFields(const StoreInfo& info) : colourShift(info.colourShift) {
    const auto offsetOf = [&](std::string_view name, std::size_t& offset) {
      const int found = info.layout.find(name);
      if (found >= 0) offset = info.layout.offset(static_cast<std::size_t>(found));
    };
    offsetOf(attribute::kRgb, rgb);
    offsetOf(attribute::kIntensity, intensity);
    offsetOf(attribute::kClassification, classification);
    offsetOf(attribute::kColourShift, ownShift);
  }

  void read(const std::byte* record, ProfilePoint& point) const {
    if (rgb != kAbsent) {
      const int shift = ownShift == kAbsent ? colourShift : std::to_integer<int>(record[ownShift]);
      point.colour = 0xff000000u;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto value = static_cast<std::uint32_t>(loadScalar(record + rgb + 2 * c, ScalarType::u16)) >> shift;
        point.colour |= std::min(value, 255u) << (8 * c);
      }
    }
    if (intensity != kAbsent)
      point.intensity = static_cast<std::uint16_t>(loadScalar(record + intensity, ScalarType::u16));
    if (classification != kAbsent) point.classification = std::to_integer<std::uint8_t>(record[classification]);
  }

  static constexpr std::size_t kAbsent = std::numeric_limits<std::size_t>::max();
  std::size_t rgb = kAbsent, intensity = kAbsent, classification = kAbsent, ownShift = kAbsent;
  int colourShift = 0;
};

/// From `a` to `b`; zero where they are one place.
glm::dvec2 unitWay(const glm::dvec2& a, const glm::dvec2& b) {
  return a == b ? glm::dvec2(0.0) : glm::normalize(b - a);
}

struct NodeAt {
  std::uint16_t store;
  std::uint32_t node;
};

/// Points of one node that are in the slab, of the first `share` of it.
void addNode(const Store& store, const RecordFields& fields, const NodeAt& at, int depth, double share,
             Profile& profile) {
  const StoreInfo& info = store.info();
  const NodePoints points = readAll(store, at.node);
  const auto end = static_cast<std::size_t>(share * static_cast<double>(points.count()));
  for (std::size_t i = 0; i < end; ++i) {
    const glm::dvec3 position =
        info.grid.offset + info.grid.scale * glm::dvec3(points.grid[0][i], points.grid[1][i], points.grid[2][i]);
    const std::optional<SlabPlace> place = placeInSlab(profile.slab, glm::dvec2(position));
    if (!place) continue;
    ProfilePoint point;
    point.position = position;
    point.along = place->along;
    point.across = place->across;
    point.depth = static_cast<std::uint8_t>(depth);
    point.store = at.store;
    point.node = at.node;
    point.index = static_cast<std::uint32_t>(i);
    fields.read(points.attributes.data() + i * info.layout.stride(), point);
    profile.points.push_back(point);
  }
}

}  // namespace

std::optional<SlabPlace> placeInSlab(const ProfileSlab& slab, const glm::dvec2& place) {
  const std::vector<glm::dvec2>& line = slab.line;
  double least = std::numeric_limits<double>::infinity(), begin = 0.0, along = 0.0;
  std::size_t nearest = line.size();
  int beyond = 0;  // -1: before the nearest segment's beginning, 1: behind its end
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const double length = glm::distance(line[i], line[i + 1]);
    if (!(length > 0.0)) continue;
    const glm::dvec2 direction = (line[i + 1] - line[i]) / length;
    const double here = glm::dot(place - line[i], direction);
    const double clamped = std::clamp(here, 0.0, length);
    const double distance = glm::distance(place, line[i] + direction * clamped);
    if (distance < least) {
      least = distance;
      nearest = i;
      along = begin + clamped;
      beyond = here < 0.0 ? -1 : here > length ? 1 : 0;
    }
    begin += length;
  }
  if (nearest == line.size() || least > 0.5 * slab.width) return std::nullopt;
  if ((nearest == 0 && beyond < 0) || (nearest + 2 == line.size() && beyond > 0)) return std::nullopt;
  // Around a corner the side is that of its two segments together: one alone may have the place on either side.
  glm::dvec2 direction = glm::normalize(line[nearest + 1] - line[nearest]);
  const glm::dvec2 from = beyond > 0 ? line[nearest + 1] : line[nearest];
  if (beyond > 0) direction += unitWay(line[nearest + 1], line[nearest + 2]);
  if (beyond < 0) direction += unitWay(line[nearest - 1], line[nearest]);
  const double side = direction.x * (place.y - from.y) - direction.y * (place.x - from.x);
  return SlabPlace{along, std::copysign(least, side)};
}

double slabLength(const ProfileSlab& slab) {
  double length = 0.0;
  for (std::size_t i = 1; i < slab.line.size(); ++i) length += glm::distance(slab.line[i - 1], slab.line[i]);
  return length;
}

bool mayTouchSlab(const ProfileSlab& slab, const Box& box) {
  const glm::dvec2 centre(box.centre());
  const double reach = 0.5 * slab.width + 0.5 * glm::length(glm::dvec2(box.size()));
  for (std::size_t i = 0; i + 1 < slab.line.size(); ++i) {
    const glm::dvec2 a = slab.line[i], way = slab.line[i + 1] - a;
    const double length2 = glm::dot(way, way);
    const double share = length2 > 0.0 ? std::clamp(glm::dot(centre - a, way) / length2, 0.0, 1.0) : 0.0;
    if (glm::distance(centre, a + way * share) <= reach * (1.0 + 1e-9)) return true;
  }
  return false;
}

Profile readProfile(std::span<const std::shared_ptr<const Store>> stores, const ProfileSlab& slab,
                    const ProfileOptions& options, std::stop_token stop, std::atomic<std::uint64_t>* found) {
  Profile profile;
  profile.slab = slab;
  profile.step = glm::dvec3(std::numeric_limits<double>::infinity());
  std::vector<RecordFields> fields;
  std::vector<NodeAt> now, next;
  for (std::size_t s = 0; s < stores.size(); ++s) {
    fields.emplace_back(stores[s]->info());
    profile.step = glm::min(profile.step, stores[s]->info().grid.scale);
    now.push_back({static_cast<std::uint16_t>(s), 0});
  }
  for (int depth = 0; !now.empty() && !stop.stop_requested(); ++depth, std::swap(now, next)) {
    next.clear();
    if (depth > options.depth || profile.share < 1.0) {
      profile.whole = false;
      break;
    }
    profile.depth = depth;
    const std::size_t before = profile.points.size();
    for (const NodeAt& at : now) {
      if (stop.stop_requested()) break;
      const Store& store = *stores[at.store];
      const NodeRecord& record = store.hierarchy().nodes[at.node];
      const Box cube = nodeCube(NodeKey{record.key}, store.info().rootCube());
      const glm::dvec3 step = store.info().grid.scale;
      if (!mayTouchSlab(slab, {cube.min - step, cube.max + step})) continue;
      for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(std::popcount(record.childMask)); ++k)
        if (record.firstChild != 0) next.push_back({at.store, record.firstChild + k});
      try {
        addNode(store, fields[at.store], at, depth, profile.share, profile);
        ++profile.nodesRead;
      } catch (const std::exception& error) {
        if (profile.nodesFailed++ == 0) profile.failure = error.what();
      }
      while (profile.points.size() > options.mostPoints) {
        profile.share *= 0.5;
        const auto beyond = [&](const ProfilePoint& p) {
          const NodeRecord& node = stores[p.store]->hierarchy().nodes[p.node];
          return p.index >= static_cast<std::uint32_t>(profile.share * node.pointCount);
        };
        profile.points.erase(
            std::remove_if(profile.points.begin() + static_cast<std::ptrdiff_t>(before), profile.points.end(), beyond),
            profile.points.end());
      }
      if (found != nullptr) found->store(profile.points.size(), std::memory_order_relaxed);
    }
  }
  if (profile.share < 1.0 || stop.stop_requested() || profile.nodesFailed > 0) profile.whole = false;
  const auto order = [](const ProfilePoint& p) { return std::tuple(p.along, p.store, p.node, p.index); };
  std::sort(profile.points.begin(), profile.points.end(),
            [&](const ProfilePoint& a, const ProfilePoint& b) { return order(a) < order(b); });
  return profile;
}

std::string profileCsv(const Profile& profile, const std::bitset<256>& classes) {
  std::string csv = "along,across,x,y,z,intensity,classification,red,green,blue\n";
  char line[160];
  for (const ProfilePoint& p : profile.points) {
    if (!classes[p.classification]) continue;
    std::snprintf(line, sizeof line, "%.4f,%.4f,", p.along, p.across);
    csv += line;
    for (int axis = 0; axis < 3; ++axis) csv += gridNumber(p.position[axis], profile.step[axis]) + ",";
    std::snprintf(line, sizeof line, "%u,%u,%u,%u,%u\n", static_cast<unsigned>(p.intensity),
                  static_cast<unsigned>(p.classification), p.colour & 255u, p.colour >> 8 & 255u,
                  p.colour >> 16 & 255u);
    csv += line;
  }
  return csv;
}

std::string profileText(const Profile& profile) {
  std::string text = readableCount(static_cast<double>(profile.points.size())) + " points";
  char more[120];
  if (profile.share < 1.0) {
    std::snprintf(more, sizeof more, ": the limit; %.3g %% of depth %d, nothing below", 100.0 * profile.share,
                  profile.depth);
    text += more;
  } else if (profile.whole) {
    text += ", all there are";
  } else if (profile.nodesFailed == 0) {
    text += " down to depth " + std::to_string(profile.depth);
  }
  if (profile.nodesFailed > 0) text += "; " + std::to_string(profile.nodesFailed) + " nodes could not be read";
  return text;
}

}  // namespace strata
