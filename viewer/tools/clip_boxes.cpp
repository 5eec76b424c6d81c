#include "viewer/tools/clip_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "viewer/camera/camera_control.h"

namespace strata {
namespace {

constexpr double kLeastSide = 1e-3;    // of a box, share of what it was
constexpr double kShareOfView = 0.33;  // of the picture's height, a new box
constexpr double kEndOn = 1e-3;        // sine of the angle between an axis and the line of sight, from which it moves

/// Along `axis` through `place`: how far its nearest point to the line of sight through `pixel` is from `place`.
std::optional<double> alongAxis(const View& view, const glm::dvec3& place, int axis, const glm::dvec2& pixel) {
  const double depth = std::max(depthOf(view, place), 1e-6);
  const glm::dvec3 origin = worldPoint(view, pixel, depth);
  const glm::dvec3 sight = glm::normalize(worldPoint(view, pixel, 2.0 * depth) - origin);
  glm::dvec3 direction(0.0);
  direction[axis] = 1.0;
  const double cosine = glm::dot(direction, sight);
  const double sine2 = 1.0 - cosine * cosine;
  if (sine2 < kEndOn * kEndOn) return std::nullopt;
  const glm::dvec3 between = origin - place;
  return (glm::dot(between, direction) - cosine * glm::dot(between, sight)) / sine2;
}

}  // namespace

Clip clipOf(const std::vector<ClipBox>& boxes, const std::vector<glm::dvec4>& planes) {
  Clip clip;
  clip.planes = planes;
  for (const ClipBox& box : boxes)
    if (box.on && clip.boxes.size() + clip.cutouts.size() < Clip::kMost)
      (box.cutout ? clip.cutouts : clip.boxes).push_back(box.box);
  return clip;
}

Box boxInView(const View& view, const Box& bounds) {
  const double depth = std::max(depthOf(view, view.target), 1e-6);
  const double half = 0.5 * kShareOfView * view.height / pixelsAt(view, 1.0, depth);
  const glm::dvec3 centre = bounds.empty() ? view.target : glm::clamp(view.target, bounds.min, bounds.max);
  Box box{centre - half, centre + half};
  if (bounds.empty()) return box;
  box.min = glm::max(box.min, bounds.min);
  box.max = glm::min(box.max, bounds.max);
  const glm::dvec3 least = glm::max(bounds.size() * kLeastSide, glm::dvec3(kLeastSide));
  for (int axis = 0; axis < 3; ++axis)
    if (box.max[axis] - box.min[axis] < least[axis]) {
      box.min[axis] = centre[axis] - least[axis];
      box.max[axis] = centre[axis] + least[axis];
    }
  return box;
}

std::vector<std::pair<glm::dvec3, glm::dvec3>> edgesOf(const Box& box) {
  const auto corner = [&](int i) {
    return glm::dvec3(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z);
  };
  std::vector<std::pair<glm::dvec3, glm::dvec3>> edges;
  for (int i = 0; i < 8; ++i)
    for (const int bit : {1, 2, 4})
      if ((i & bit) == 0) edges.emplace_back(corner(i), corner(i | bit));
  return edges;
}

glm::dvec3 handlePlace(const Box& box, ClipHandle handle) {
  glm::dvec3 place = box.centre();
  if (handle == ClipHandle::centre) return place;
  const int face = static_cast<int>(handle);
  place[face / 2] = (face % 2 == 0 ? box.min : box.max)[face / 2];
  return place;
}

Box draggedBox(const Box& box, ClipHandle handle, const View& view, const glm::dvec2& from, const glm::dvec2& to) {
  const glm::dvec3 place = handlePlace(box, handle);
  Box next = box;
  if (handle == ClipHandle::centre) {
    const double depth = std::max(depthOf(view, place), 1e-6);
    const glm::dvec3 shift = worldPoint(view, to, depth) - worldPoint(view, from, depth);
    next.min += shift;
    next.max += shift;
    return next;
  }
  const int face = static_cast<int>(handle);
  const int axis = face / 2;
  const std::optional<double> begun = alongAxis(view, place, axis, from);
  const std::optional<double> now = alongAxis(view, place, axis, to);
  if (!begun || !now || !std::isfinite(*now - *begun)) return box;
  const double least = kLeastSide * (box.max[axis] - box.min[axis]);
  if (face % 2 == 0)
    next.min[axis] = std::min(box.min[axis] + (*now - *begun), box.max[axis] - least);
  else
    next.max[axis] = std::max(box.max[axis] + (*now - *begun), box.min[axis] + least);
  return next;
}

bool ClipTool::add(const Box& box) {
  if (boxes_.size() >= Clip::kMost) return false;
  for (int number = 1;; ++number) {
    const std::string name = "box " + std::to_string(number);
    if (std::any_of(boxes_.begin(), boxes_.end(), [&](const ClipBox& b) { return b.name == name; })) continue;
    boxes_.push_back({name, box, false, true});
    return true;
  }
}

void ClipTool::remove(std::size_t index) {
  if (index >= boxes_.size()) return;
  boxes_.erase(boxes_.begin() + static_cast<std::ptrdiff_t>(index));
  held_.reset();
}

std::optional<ClipTool::Grip> ClipTool::gripAt(const View& view, const glm::dvec2& cursor) const {
  std::optional<Grip> nearest;
  double least = kReachPx;
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    if (!boxes_[i].on) continue;
    for (int h = 0; h < kClipHandles; ++h) {
      const glm::dvec3 place = handlePlace(boxes_[i].box, static_cast<ClipHandle>(h));
      if (depthOf(view, place) <= view.nearPlane) continue;
      const double distance = glm::distance(pixelOf(view, place), cursor);
      if (distance > least) continue;
      least = distance;
      nearest = Grip{i, static_cast<ClipHandle>(h)};
    }
  }
  return nearest;
}

bool ClipTool::press(const View& view, const glm::dvec2& cursor) {
  held_ = gripAt(view, cursor);
  if (!held_) return false;
  start_ = boxes_[held_->box].box;
  pressed_ = cursor;
  return true;
}

bool ClipTool::move(const View& view, const glm::dvec2& cursor) {
  if (!held_) return false;
  Box& box = boxes_[held_->box].box;
  const Box next = draggedBox(start_, held_->handle, view, pressed_, cursor);
  const bool changed = next.min != box.min || next.max != box.max;
  box = next;
  return changed;
}

}  // namespace strata
