#include "viewer/camera/camera_control.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <utility>

namespace strata {
namespace {

constexpr double kSteepest = 89.0 * std::numbers::pi / 180.0;  // elevation of the eye, so that up stays defined
constexpr double kZoomPerNotch = 0.85;
constexpr double kFlySpeed = 0.5;  // share of the distance to the target, per second
constexpr double kApproach = 0.4;  // of the distance, a double click
constexpr double kFastFactor = 5.0;
constexpr double kNearest = 1e-4;  // metres; a zoom stops here

glm::dvec3 rotated(const glm::dvec3& v, double angle, const glm::dvec3& axis) {
  return glm::angleAxis(angle, axis) * v;
}

}  // namespace

glm::dvec3 worldPoint(const View& view, const glm::dvec2& pixel, double depth) {
  const ViewBasis basis = viewBasis(view);
  const double metresPerPixel = 1.0 / pixelsAt(view, 1.0, depth);
  return view.eye + basis.forward * depth + basis.right * ((pixel.x - 0.5 * view.width) * metresPerPixel) -
         basis.up * ((pixel.y - 0.5 * view.height) * metresPerPixel);
}

double depthOf(const View& view, const glm::dvec3& point) {
  return glm::dot(viewBasis(view).forward, point - view.eye);
}

glm::dvec2 pixelOf(const View& view, const glm::dvec3& point) {
  const Projection p = projection(view);
  const glm::dvec4 d(point - p.eye, 1.0);
  return glm::dvec2(glm::dot(p.rowX, d), glm::dot(p.rowY, d)) / glm::dot(p.rowW, d);
}

std::optional<std::pair<glm::dvec2, glm::dvec2>> segmentOnScreen(const View& view, glm::dvec3 a, glm::dvec3 b) {
  const double depthA = depthOf(view, a);
  const double depthB = depthOf(view, b);
  const double least = std::max(view.nearPlane, 1e-9);
  if (depthA < least && depthB < least) return std::nullopt;
  // A little before the near plane: exactly on it, rounding could put an end behind the eye.
  const double at = least * 1.0001;
  const auto cut = [&](const glm::dvec3& behind, double depthBehind, const glm::dvec3& before, double depthBefore) {
    return before + (behind - before) * ((depthBefore - at) / (depthBefore - depthBehind));
  };
  if (depthA < least) a = cut(a, depthA, b, depthB);
  if (depthB < least) b = cut(b, depthB, a, depthOf(view, a));
  return std::pair(pixelOf(view, a), pixelOf(view, b));
}

View orbited(const View& view, const glm::dvec3& pivot, const glm::dvec2& dragPx) {
  const double perPixel = std::numbers::pi / std::max(view.width, 1);
  const glm::dvec3 up(0.0, 0.0, 1.0);
  const ViewBasis basis = viewBasis(view);
  const double elevation = -std::asin(std::clamp(basis.forward.z, -1.0, 1.0));
  const double wanted = std::clamp(elevation + dragPx.y * perPixel, -kSteepest, kSteepest);
  const double yaw = -dragPx.x * perPixel;
  const auto turn = [&](const glm::dvec3& v) { return rotated(rotated(v, elevation - wanted, basis.right), yaw, up); };
  View next = view;
  next.eye = pivot + turn(view.eye - pivot);
  next.target = next.eye + turn(view.target - view.eye);
  next.up = up;
  return next;
}

View panned(const View& view, double depth, const glm::dvec2& dragPx) {
  const ViewBasis basis = viewBasis(view);
  const double metresPerPixel = 1.0 / pixelsAt(view, 1.0, depth);
  const glm::dvec3 shift = (basis.up * dragPx.y - basis.right * dragPx.x) * metresPerPixel;
  View next = view;
  next.eye += shift;
  next.target += shift;
  return next;
}

View slid(const View& view, const glm::dvec3& grabbed, const glm::dvec2& cursor) {
  // Two points of the ray through the cursor; with the grabbed point's depth as the scale of it all.
  const double depth = std::max(depthOf(view, grabbed), view.nearPlane);
  const glm::dvec3 near = worldPoint(view, cursor, depth);
  const glm::dvec3 ray = worldPoint(view, cursor, 2.0 * depth) - near;
  if (ray.z == 0.0) return view;
  const double along = (grabbed.z - near.z) / ray.z;
  const glm::dvec3 hit = near + ray * along;
  const double distance = glm::distance(view.eye, grabbed);
  if (!view.orthographic && along <= -1.0) return view;  // behind the eye
  if (!(glm::distance(hit, grabbed) <= kFarthestSlide * distance)) return view;
  const glm::dvec3 shift(grabbed.x - hit.x, grabbed.y - hit.y, 0.0);
  View next = view;
  next.eye += shift;
  next.target += shift;
  return next;
}

View looked(const View& view, const glm::dvec2& dragPx) { return orbited(view, view.eye, dragPx); }

View zoomed(const View& view, const glm::dvec3& anchor, double factor) {
  View next = view;
  if (factor < 1.0 && glm::length(view.eye - anchor) < kNearest) return next;
  next.eye = anchor + (view.eye - anchor) * factor;
  // The target keeps the view's direction: both move by the same scaling about the anchor.
  next.target = anchor + (view.target - anchor) * factor;
  if (glm::length(next.target - next.eye) < kNearest) return view;
  next.orthographicHeight = view.orthographicHeight * factor;
  return next;
}

double flySpeed(const View& view, bool fast) {
  return kFlySpeed * glm::length(view.target - view.eye) * (fast ? kFastFactor : 1.0);
}

View paced(const View& view, double notches) {
  View next = view;
  next.target = view.eye + (view.target - view.eye) * std::pow(kZoomPerNotch, -notches);
  return glm::distance(next.target, next.eye) < kNearest ? view : next;
}

View flown(const View& view, const FlyInput& input, double seconds) {
  const ViewBasis basis = viewBasis(view);
  const double speed = flySpeed(view, input.fast);
  const glm::dvec3 shift =
      (basis.forward * static_cast<double>(input.forward) + basis.right * static_cast<double>(input.right) +
       glm::dvec3(0.0, 0.0, 1.0) * static_cast<double>(input.up)) *
      (speed * seconds);
  View next = view;
  next.eye += shift;
  next.target += shift;
  return next;
}

View framed(const View& view, const Box& box) {
  View next = view;
  const View seen = viewOfBox(box, viewBasis(view).forward, view.width, view.height, view.fovY);
  next.eye = seen.eye;
  next.target = seen.target;
  next.orthographicHeight = std::max(box.diagonal(), 1e-6);
  return next;
}

View standardView(const View& view, const Box& box, StandardView which) {
  View turned = view;
  turned.up = which == StandardView::top ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
  const glm::dvec3 direction = which == StandardView::front  ? glm::dvec3(0.0, 1.0, 0.0)
                               : which == StandardView::side ? glm::dvec3(-1.0, 0.0, 0.0)
                                                             : glm::dvec3(0.0, 0.0, -1.0);
  turned.target = turned.eye + direction;
  return framed(turned, box);
}

View withOrthographic(const View& view, bool orthographic) {
  View next = view;
  next.orthographic = orthographic;
  const double distance = glm::length(view.target - view.eye);
  const double tangent = std::tan(0.5 * view.fovY);
  if (orthographic && !view.orthographic) next.orthographicHeight = 2.0 * distance * tangent;
  // A zoom without perspective changes the height alone: step back to where it is seen as high.
  if (!orthographic && view.orthographic)
    next.eye = view.target + (view.eye - view.target) * (0.5 * view.orthographicHeight / tangent / distance);
  return next;
}

View approached(const View& view, const glm::dvec3& point) {
  View next = view;
  next.target = point;
  const double distance = std::max(kApproach * glm::distance(view.eye, point), kNearest);
  next.eye = point - viewBasis(view).forward * distance;
  next.orthographicHeight = std::max(kApproach * view.orthographicHeight, kNearest);
  return next;
}

View glided(const View& from, const View& to, double u) {
  if (u >= 1.0) return to;
  const double s = u * u * (3.0 - 2.0 * u);
  const auto ratio = [s](double a, double b) { return a * std::pow(b / a, s); };
  const glm::dvec3 away = from.eye - from.target;
  const glm::dvec3 awayTo = to.eye - to.target;
  const glm::dvec3 a = glm::normalize(away);
  const glm::dvec3 b = glm::normalize(awayTo);
  const double angle = std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
  // Opposite directions have no shortest way; any axis square to them will do.
  glm::dvec3 axis = glm::cross(a, b);
  if (glm::length(axis) < 1e-9) axis = glm::cross(a, std::abs(a.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0));
  View now = to;
  now.width = from.width;
  now.height = from.height;
  now.target = glm::mix(from.target, to.target, s);
  now.eye = now.target + rotated(a, s * angle, glm::normalize(axis)) * ratio(glm::length(away), glm::length(awayTo));
  now.up = glm::mix(from.up, to.up, s);
  if (glm::length(now.up) < 1e-6) now.up = to.up;
  now.orthographicHeight = ratio(from.orthographicHeight, to.orthographicHeight);
  return now;
}

const char* modeName(MoveMode mode) {
  return mode == MoveMode::orbit ? "orbit" : mode == MoveMode::fly ? "fly" : "earth";
}

MoveMode nextMode(MoveMode mode) {
  return mode == MoveMode::orbit ? MoveMode::fly : mode == MoveMode::fly ? MoveMode::earth : MoveMode::orbit;
}

void CameraControl::advance(double seconds) {
  if (!glide_) return;
  glide_->u += seconds / kGlideSeconds;
  const int width = view_.width, height = view_.height;
  view_ = glided(glide_->from, glide_->to, glide_->u);
  if (glide_->u >= 1.0) glide_.reset();
  resize(width, height);
}

View CameraMotion::ahead(const View& now, std::chrono::steady_clock::time_point time) {
  const double seconds = std::chrono::duration<double>(time - lastTime_).count();
  const View last = std::exchange(last_, now);
  lastTime_ = time;
  View view = now;
  const double frames = kAheadSeconds / seconds;
  const glm::dvec3 way = (now.eye - last.eye) * frames;
  // A jump, or the first frame after a pause, is no motion to go on with.
  constexpr double kLongestPause = 0.25;
  if (!(seconds > 0.0 && seconds < kLongestPause) || glm::length(way) > glm::length(now.target - now.eye)) return view;
  view.eye += way;
  view.target += (now.target - last.target) * frames;
  return view;
}

void CameraControl::resize(int width, int height) {
  view_.width = std::max(width, 1);
  view_.height = std::max(height, 1);
}

void CameraControl::pressLeft(const glm::dvec2& cursor, const std::optional<glm::dvec3>& under) {
  press(mode_ == MoveMode::fly ? Drag::look : mode_ == MoveMode::earth ? Drag::slide : Drag::orbit, cursor, under);
}

void CameraControl::pressRight(const glm::dvec2& cursor, const std::optional<glm::dvec3>& under) {
  press(mode_ == MoveMode::earth ? Drag::orbit : Drag::pan, cursor, under);
}

void CameraControl::press(Drag drag, const glm::dvec2& cursor, const std::optional<glm::dvec3>& under) {
  glide_.reset();
  drag_ = drag;
  cursor_ = cursor;
  anchor_ = under.value_or(view_.target);
}

void CameraControl::move(const glm::dvec2& cursor) {
  if (drag_ == Drag::orbit) view_ = orbited(view_, anchor_, cursor - cursor_);
  if (drag_ == Drag::pan) view_ = panned(view_, std::max(depthOf(view_, anchor_), view_.nearPlane), cursor - cursor_);
  if (drag_ == Drag::look) view_ = looked(view_, cursor - cursor_);
  if (drag_ == Drag::slide) view_ = slid(view_, anchor_, cursor);
  cursor_ = cursor;
}

void CameraControl::wheel(double notches, const glm::dvec2& cursor, const std::optional<glm::dvec3>& under) {
  if (mode_ == MoveMode::fly) {
    setView(paced(view_, notches));
    return;
  }
  const glm::dvec3 anchor = under ? *under : worldPoint(view_, cursor, depthOf(view_, view_.target));
  setView(zoomed(view_, anchor, std::pow(kZoomPerNotch, notches)));
}

}  // namespace strata
