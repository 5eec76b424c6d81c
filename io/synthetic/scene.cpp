#include "io/synthetic/scene.h"

#include <algorithm>
#include <cmath>

#include "io/synthetic/random.h"

namespace strata::synthetic {
namespace {

/// The way of a ray inside a box, from `near` to `far`, and the axis through whose side it enters.
struct RayInterval {
  float near, far;
  int axis;
};

RayInterval intervalInBox(const Primitive& p, const Ray& ray) {
  const glm::vec3 a = (p.min - ray.origin) * ray.inverse;
  const glm::vec3 b = (p.max - ray.origin) * ray.inverse;
  const glm::vec3 low = glm::min(a, b), high = glm::max(a, b);
  int axis = low.x > low.y ? 0 : 1;
  if (low.z > low[axis]) axis = 2;
  return {low[axis], std::min(high.x, std::min(high.y, high.z)), axis};
}

glm::vec3 sideNormal(const Ray& ray, int axis) {
  glm::vec3 normal(0.0f);
  normal[axis] = ray.direction[axis] > 0.0f ? -1.0f : 1.0f;
  return normal;
}

bool accept(float t, const glm::vec3& normal, int index, Hit& hit) {
  if (!(t > 0.0f && t < hit.t)) return false;
  hit = {t, index, normal};
  return true;
}

/// Cuts the ray's way through the box at the sloping planes, which is enough because a roof is convex.
bool intersectRoof(const Primitive& p, int index, const Ray& ray, const RayInterval& inside, Hit& hit) {
  float near = inside.near, far = inside.far;
  glm::vec3 normal = sideNormal(ray, inside.axis);
  for (int axis = 0; axis < 2; ++axis) {
    const float slope = p.slope[axis];
    if (slope <= 0.0f) continue;
    for (const float sign : {-1.0f, 1.0f}) {
      // Inside: z - min.z <= slope * distance from the side that this plane rises from.
      const float edge = sign > 0.0f ? p.max[axis] : p.min[axis];
      const float outside = ray.origin.z - p.min.z + sign * slope * (ray.origin[axis] - edge);
      const float speed = ray.direction.z + sign * slope * ray.direction[axis];
      const float t = -outside / speed;
      if (speed < 0.0f) {
        if (t > near) {
          near = t;
          normal = glm::vec3(0.0f, 0.0f, 1.0f);
          normal[axis] = sign * slope;
        }
      } else if (speed > 0.0f) {
        far = std::min(far, t);
      } else if (outside > 0.0f) {
        return false;
      }
    }
  }
  return near <= far && accept(near, glm::normalize(normal), index, hit);
}

bool intersectCone(const Primitive& p, int index, const Ray& ray, const RayInterval& inside, Hit& hit) {
  const glm::vec3 middle = (p.min + p.max) * 0.5f;
  const float radius = (p.max.x - p.min.x) * 0.5f;
  const float shrink = radius * (1.0f - p.taper) / (p.max.z - p.min.z);  // radius lost per metre of height
  if (inside.axis == 2) {  // through the lid or the base, if within its circle
    const glm::vec3 at = ray.origin + ray.direction * inside.near - middle;
    const float r = ray.direction.z > 0.0f ? radius : radius * p.taper;
    if (at.x * at.x + at.y * at.y <= r * r) return accept(inside.near, sideNormal(ray, 2), index, hit);
  }
  const glm::vec2 o(ray.origin.x - middle.x, ray.origin.y - middle.y);
  const glm::vec2 d(ray.direction.x, ray.direction.y);
  const float r0 = radius - shrink * (ray.origin.z - p.min.z), dr = -shrink * ray.direction.z;
  const float a = glm::dot(d, d) - dr * dr, b = glm::dot(o, d) - r0 * dr, c = glm::dot(o, o) - r0 * r0;
  const float discriminant = b * b - a * c;
  if (discriminant < 0.0f || a == 0.0f) return false;
  const float root = std::sqrt(discriminant);
  for (const float t : {(-b - root) / a, (-b + root) / a}) {
    const float z = ray.origin.z + ray.direction.z * t;
    if (z < p.min.z || z > p.max.z || r0 + dr * t < 0.0f) continue;
    const glm::vec2 out = o + d * t;
    const glm::vec3 normal = glm::normalize(glm::vec3(out.x, out.y, glm::length(out) * shrink));
    if (glm::dot(normal, ray.direction) >= 0.0f) continue;  // the way out, or the mirrored cone
    return accept(t, normal, index, hit);
  }
  return false;
}

/// A ray seen from a ball of radius 1, which it is inside of from `near` to `far`.
struct BallRay {
  glm::vec3 origin, direction;
  float near, far;
};

/// Lets a ray go into leaves in exponential steps until one of them ends at a twig. Twigs are fewer towards the
/// outside, which frays the outline of the crown. Returns how far the ray came, more than `far` when it met nothing.
float leafAlong(const Primitive& p, int index, const Ray& ray, const BallRay& inBall) {
  constexpr int kSteps = 5;
  constexpr float kTwigsPerMetre = 3.2f;
  CounterRandom random(ray.seed, static_cast<std::uint64_t>(index));
  float t = inBall.near;
  for (int step = 0; step < kSteps; ++step) {
    t -= p.meanFreePath * std::log(1.0f - random.uniformFloat());
    if (t > inBall.far) break;
    const glm::vec3 in = inBall.origin + inBall.direction * t;
    const glm::ivec3 twig(glm::floor((ray.origin + ray.direction * t) * kTwigsPerMetre));
    const float fromMiddle = glm::dot(in, in);
    if (cellHash(twig.x + twig.z * 977, twig.y, p.seed) > fromMiddle * fromMiddle * 0.85f) return t;
  }
  return inBall.far + 1.0f;
}

bool intersectEllipsoid(const Primitive& p, int index, const Ray& ray, Hit& hit) {
  const glm::vec3 middle = (p.min + p.max) * 0.5f;
  const glm::vec3 scale = 2.0f / (p.max - p.min);
  const glm::vec3 o = (ray.origin - middle) * scale, d = ray.direction * scale;
  const float a = glm::dot(d, d), b = glm::dot(o, d), c = glm::dot(o, o) - 1.0f;
  const float discriminant = b * b - a * c;
  if (discriminant <= 0.0f) return false;
  const float root = std::sqrt(discriminant);
  float t = (-b - root) / a;
  if (p.kind == PrimitiveKind::foliage) {
    const float far = (-b + root) / a;
    t = leafAlong(p, index, ray, {o, d, std::max(t, 0.0f), far});
    if (t > far) return false;
  }
  return accept(t, glm::normalize((o + d * t) * scale), index, hit);
}

/// The column of the grid that holds a position.
glm::ivec2 column(const glm::vec2& position, const glm::vec2& origin, float cellSize, const glm::ivec2& cells) {
  const glm::ivec2 cell(glm::floor((position - origin) / cellSize));
  return glm::clamp(cell, glm::ivec2(0), cells - 1);
}

}  // namespace

Ray::Ray(const glm::vec3& rayOrigin, const glm::vec3& rayDirection, std::uint64_t raySeed)
    : origin(rayOrigin), direction(rayDirection), seed(raySeed) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(direction[axis]) < 1e-9f) direction[axis] = 1e-9f;
  }
  inverse = 1.0f / direction;
}

bool intersect(const Primitive& primitive, int index, const Ray& ray, Hit& hit) {
  const RayInterval inside = intervalInBox(primitive, ray);
  if (inside.near > inside.far || inside.far < 0.0f || inside.near >= hit.t) return false;
  switch (primitive.kind) {
    case PrimitiveKind::box:
      return accept(inside.near, sideNormal(ray, inside.axis), index, hit);
    case PrimitiveKind::roof:
      return intersectRoof(primitive, index, ray, inside, hit);
    case PrimitiveKind::cone:
      return intersectCone(primitive, index, ray, inside, hit);
    case PrimitiveKind::ellipsoid:
    case PrimitiveKind::foliage:
      return intersectEllipsoid(primitive, index, ray, hit);
  }
  return false;
}

Scene::Scene(std::vector<Primitive> primitives, const glm::vec2& groundMin, const glm::vec2& groundMax, float cellSize)
    : primitives_(std::move(primitives)),
      groundMin_(groundMin),
      groundMax_(groundMax),
      cellSize_(cellSize),
      cells_(glm::max(glm::ivec2(glm::ceil((groundMax - groundMin) / cellSize)), glm::ivec2(1))) {
  const std::size_t count = static_cast<std::size_t>(cells_.x) * static_cast<std::size_t>(cells_.y);
  std::vector<std::vector<std::uint32_t>> lists(count);
  cellTop_.assign(count, 0.0f);
  for (std::uint32_t i = 0; i < primitives_.size(); ++i) {
    const Primitive& p = primitives_[i];
    top_ = std::max(top_, p.max.z);
    const glm::ivec2 low = column(glm::vec2(p.min.x, p.min.y), groundMin_, cellSize_, cells_);
    const glm::ivec2 high = column(glm::vec2(p.max.x, p.max.y), groundMin_, cellSize_, cells_);
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) {
        const std::size_t cell =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_.x) + static_cast<std::size_t>(x);
        lists[cell].push_back(i);
        cellTop_[cell] = std::max(cellTop_[cell], p.max.z);
      }
    }
  }
  cellStart_.push_back(0);
  for (const std::vector<std::uint32_t>& list : lists) {
    cellItems_.insert(cellItems_.end(), list.begin(), list.end());
    cellStart_.push_back(static_cast<std::uint32_t>(cellItems_.size()));
  }
}

/// Amanatides and Woo 1987 over columns; a column is passed over where the ray stays above its highest object.
template <bool kAnyHit>
bool Scene::walk(const Ray& ray, float reach, Hit& hit) const {
  const glm::vec2 origin(ray.origin.x, ray.origin.y);
  const float atTop = (top_ - ray.origin.z) * ray.inverse.z;  // nothing lies above
  const bool fallsIn = ray.direction.z < 0.0f && atTop > 0.0f;
  const glm::vec2 start = fallsIn ? origin + glm::vec2(ray.direction.x, ray.direction.y) * atTop : origin;
  glm::ivec2 cell(glm::floor((start - groundMin_) / cellSize_));
  glm::vec2 next, delta;
  glm::ivec2 step;
  for (int axis = 0; axis < 2; ++axis) {
    const bool forward = ray.direction[axis] > 0.0f;
    step[axis] = forward ? 1 : -1;
    const float border = groundMin_[axis] + static_cast<float>(cell[axis] + (forward ? 1 : 0)) * cellSize_;
    next[axis] = (border - origin[axis]) * ray.inverse[axis];
    delta[axis] = cellSize_ * std::abs(ray.inverse[axis]);
  }
  const float end = std::min({hit.t, reach, ray.direction.z > 0.0f ? atTop : reach});
  hit.t = end;
  bool found = false;
  for (float enter = fallsIn ? atTop : 0.0f; enter < hit.t;) {
    if (cell.x < 0 || cell.y < 0 || cell.x >= cells_.x || cell.y >= cells_.y) break;
    const float leave = std::min(next.x, next.y);
    const std::size_t at =
        static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(cells_.x) + static_cast<std::size_t>(cell.x);
    const float lowest = ray.origin.z + ray.direction.z * (ray.direction.z > 0.0f ? enter : std::min(leave, end));
    if (lowest <= cellTop_[at]) {
      for (std::uint32_t i = cellStart_[at]; i < cellStart_[at + 1]; ++i) {
        const std::uint32_t item = cellItems_[i];
        found |= intersect(primitives_[item], static_cast<int>(item), ray, hit);
        if (kAnyHit && found) return true;
      }
    }
    const int axis = next.x < next.y ? 0 : 1;
    cell[axis] += step[axis];
    next[axis] += delta[axis];
    enter = leave;
  }
  return found;
}

bool Scene::trace(const Ray& ray, float reach, Hit& hit) const {
  hit = Hit{};
  bool ground = false;
  if (ray.direction.z < 0.0f) {
    const float t = -ray.origin.z * ray.inverse.z;
    const glm::vec3 at = ray.origin + ray.direction * t;
    ground = t > 0.0f && t < reach && at.x >= groundMin_.x && at.y >= groundMin_.y && at.x <= groundMax_.x &&
             at.y <= groundMax_.y;
    if (ground) hit.t = t;
  }
  return walk<false>(ray, reach, hit) || ground;
}

bool Scene::blocked(const Ray& ray, float reach) const {
  Hit hit;
  return walk<true>(ray, reach, hit);
}

bool Scene::isFree(const glm::vec3& centre, float radius) const {
  return std::none_of(primitives_.begin(), primitives_.end(), [&](const Primitive& p) {
    return glm::distance(glm::clamp(centre, p.min, p.max), centre) < radius;
  });
}

}  // namespace strata::synthetic
