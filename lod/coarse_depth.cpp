#include "lod/coarse_depth.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace strata {
namespace {

constexpr int kEach = CoarseDepth::kSamplesACell;
/// Rows whose spans are solved together: one vector of floats.
constexpr int kRows = 8;
/// An eye that is nearer to a surface's plane than this many times its thickness sees it edge-on.
constexpr double kEdgeOn = 2.0;
/// The least width of an occluder's cell in samples. Smaller ones would close too few samples to be worth the time.
constexpr double kLeastSamples = 4.0;
/// A node has to lie behind an occluder by this share of its depth, because floats round.
constexpr float kBehind = 1e-5f;

/// Four samples side by side.
using Four = float __attribute__((vector_size(16)));
/// One value for each of the rows that are solved together.
using Rows = float __attribute__((vector_size(kRows * sizeof(float))));

/// line[x] = max(line[x], start + step * x) for x in [begin, end), four at a time; the last four overlap those before.
void raiseSpan(float* line, int begin, int end, float start, float step) {
  if (end - begin < 4) {
    for (int x = begin; x < end; ++x) line[x] = std::max(line[x], start + step * static_cast<float>(x));
    return;
  }
  const Four ramp = Four{0.0f, 1.0f, 2.0f, 3.0f} * step + start;
  const auto at = [line](int x) {
    Four samples;
    std::memcpy(&samples, line + x, sizeof samples);
    return samples;
  };
  const auto raise = [&](int x, Four old) {
    const Four now = ramp + step * static_cast<float>(x);
    const Four most = now > old ? now : old;
    std::memcpy(line + x, &most, sizeof most);
  };
  // Read before a part of it is written: loading what has just been stored in pieces is slow.
  const Four last = at(end - 4);
  for (int x = begin; x < end - 4; x += 4) raise(x, at(x));
  raise(end - 4, last);
}

}  // namespace

CoarseDepth::CoarseDepth()
    : samples_(std::size_t{kSamples} * kSamples, 0.0f),
      narrowed_(std::size_t{kSide} * kSamples, 0.0f),
      cells_(std::size_t{kSide} * kSide, 0.0f) {}

CoarseDepth::Nearness CoarseDepth::nearnessOf(double depth) const {
  return static_cast<Nearness>(view_.orthographic ? -depth : 1.0 / depth);
}

void CoarseDepth::clear(const View& view, const OcclusionOptions& options) {
  view_ = view;
  options_ = options;
  basis_ = viewBasis(view);
  projection_ = projection(view);
  pixelsPerMetre_ =
      view.orthographic ? view.height / view.orthographicHeight : 0.5 * view.height / std::tan(0.5 * view.fovY);
  open_ = view.orthographic ? -std::numeric_limits<float>::max() : 0.0f;
  drawn_ = 0;
  firstRow_ = kSamples;
  lastRow_ = -1;
  std::fill(samples_.begin(), samples_.end(), open_);
  std::fill(cells_.begin(), cells_.end(), open_);
}

void CoarseDepth::add(const OccluderSet& set) {
  if (!options_.enabled || set.occluders.empty()) return;
  const glm::dvec3 fromEye = set.origin - view_.eye;
  const double radius = set.cellSide * OccluderSet::kCells * 0.5 * std::sqrt(3.0);
  const double nearest = glm::dot(fromEye, basis_.forward) - radius;
  if (nearest + 2.0 * radius <= view_.nearPlane) return;
  const double sidePx =
      set.cellSide * pixelsPerMetre_ / (view_.orthographic ? 1.0 : std::max(nearest, view_.nearPlane));
  if (sidePx * kSamples < kLeastSamples * std::max(view_.width, view_.height)) return;
  for (const Occluder& occluder : set.occluders) {
    if (drawn_ >= options_.mostOccluders) return;
    Polygon polygon;
    if (!project(occluder, fromEye, polygon)) continue;
    fill(polygon);
    ++drawn_;
  }
}

bool CoarseDepth::project(const Occluder& occluder, const glm::dvec3& originFromEye, Polygon& out) const {
  const glm::dvec3 normal(occluder.normal);
  // The plane relative to the eye, dot(normal, d) = along, and the far side of its layer.
  const double along = static_cast<double>(occluder.offset) + glm::dot(normal, originFromEye);
  const double thickness = static_cast<double>(occluder.back);
  const double towards = view_.orthographic ? glm::dot(normal, basis_.forward) : along;
  if (std::abs(along) < kEdgeOn * thickness && !view_.orthographic) return false;
  const double farSide = along + (towards > 0.0 ? thickness : -thickness);

  // Only the part that is far enough away for its gaps to be small enough on the screen.
  const double mostPx = occluder.whole ? options_.gapPixels : options_.openGapPixels;
  const double gapPx = static_cast<double>(occluder.gap) * pixelsPerMetre_;  // at 1 m, or everywhere
  if (view_.orthographic && gapPx > mostPx) return false;
  const double from = view_.orthographic ? view_.nearPlane : std::max(view_.nearPlane, gapPx / mostPx);

  std::array<glm::dvec4, Occluder::kMaxCorners> corner;
  std::array<double, Occluder::kMaxCorners> beyond;
  for (std::size_t i = 0; i < occluder.corners; ++i) {
    corner[i] = glm::dvec4(originFromEye + glm::dvec3(occluder.corner[i]), 1.0);
    beyond[i] = glm::dot(projection_.rowDepth, corner[i]) - from;
  }
  const double perX = static_cast<double>(kSamples) / view_.width, perY = static_cast<double>(kSamples) / view_.height;
  glm::vec2 low(std::numeric_limits<float>::max()), high(-std::numeric_limits<float>::max());
  out.corners = 0;
  const auto add = [&](const glm::dvec4& d) {
    const double w = glm::dot(projection_.rowW, d);
    const glm::vec2 at(static_cast<float>(glm::dot(projection_.rowX, d) / w * perX),
                       static_cast<float>(glm::dot(projection_.rowY, d) / w * perY));
    low = glm::min(low, at);
    high = glm::max(high, at);
    out.corner[out.corners++] = at;
  };
  for (std::size_t i = 0; i < occluder.corners; ++i) {
    const std::size_t next = i + 1 < occluder.corners ? i + 1 : 0;
    if (beyond[i] > 0.0) add(corner[i]);
    if ((beyond[i] > 0.0) != (beyond[next] > 0.0))
      add(glm::mix(corner[i], corner[next], beyond[i] / (beyond[i] - beyond[next])));
  }
  const auto side = static_cast<float>(kSamples);
  if (out.corners < 3 || high.x < 0.0f || high.y < 0.0f || low.x > side || low.y > side) return false;
  return linearNearness(normal, farSide, 1.0 / perX, 1.0 / perY, out.nearness);
}

bool CoarseDepth::linearNearness(const glm::dvec3& normal, double along, double stepX, double stepY,
                                 Linear& out) const {
  // A ray of depth 1 through (x, y) of the picture meets the plane dot(normal, d) = along at the depth z with
  // 1 / z = normal . ray / along, which is linear in x and y.
  const double pixel = 1.0 / pixelsPerMetre_;
  const double toForward = glm::dot(normal, basis_.forward);
  const double perColumn = glm::dot(normal, basis_.right) * pixel, perRow = -glm::dot(normal, basis_.up) * pixel;
  double divisor = along, constant = toForward;
  if (view_.orthographic) {  // z = (along - normal . place) / (normal . forward)
    divisor = toForward;
    constant = -along;
  }
  if (!(std::abs(divisor) > 1e-9)) return false;
  out.a = static_cast<float>((constant - perColumn * 0.5 * view_.width - perRow * 0.5 * view_.height) / divisor);
  out.b = static_cast<float>(perColumn * stepX / divisor);
  out.c = static_cast<float>(perRow * stepY / divisor);
  return true;
}

void CoarseDepth::fill(const Polygon& polygon) {
  float top = polygon.corner[0].y, bottom = top, twiceArea = 0.0f;
  for (std::size_t i = 0; i < polygon.corners; ++i) {
    const glm::vec2 a = polygon.corner[i], b = polygon.corner[(i + 1) % polygon.corners];
    top = std::min(top, a.y);
    bottom = std::max(bottom, a.y);
    twiceArea += a.x * b.y - b.x * a.y;
  }
  if (!(std::abs(twiceArea) > 1e-6f)) return;
  // Samples lie in the middle of their squares: row r at y = r + 0.5.
  const int first = static_cast<int>(std::clamp(std::ceil(top - 0.5f), 0.0f, static_cast<float>(kSamples)));
  const int last = static_cast<int>(std::clamp(std::floor(bottom - 0.5f), -1.0f, kSamples - 1.0f));
  if (first > last) return;
  firstRow_ = std::min(firstRow_, first);
  lastRow_ = std::max(lastRow_, last);

  constexpr Rows kOrder{0.0f, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 7.0f};
  for (int row = first; row <= last; row += kRows) {
    Rows from = {}, to = Rows{} + static_cast<float>(kSamples);
    for (std::size_t i = 0; i < polygon.corners; ++i) {
      // A point p is inside an edge when (b - a) x (p - a) >= 0, for a polygon that runs clockwise on the screen.
      glm::vec2 a = polygon.corner[i], b = polygon.corner[i + 1 < polygon.corners ? i + 1 : 0];
      if (twiceArea < 0.0f) std::swap(a, b);
      const glm::vec2 d = b - a;
      if (std::abs(d.y) < 1e-6f) continue;  // a level edge bounds rows, and `first` and `last` do that already
      const float slope = d.x / d.y;
      const Rows edge = kOrder * slope + (a.x + (static_cast<float>(row) + 0.5f - a.y) * slope);
      if (d.y > 0.0f)  // inside is to the left
        to = edge < to ? edge : to;
      else
        from = edge > from ? edge : from;
    }
    // The first sample whose middle is not before `from`, and the first one beyond `to`.
    int begin[kRows], end[kRows];
    for (int r = 0; r < kRows; ++r) {
      begin[r] = static_cast<int>(std::min(from[r], static_cast<float>(kSamples)) + 0.5f);
      end[r] = static_cast<int>(std::max(to[r], 0.0f) + 0.5f);
    }
    for (int r = 0; r < kRows && row + r <= last; ++r)
      raiseSpan(samples_.data() + static_cast<std::size_t>(row + r) * kSamples, begin[r], end[r],
                polygon.nearness.at(0.5f, static_cast<float>(row + r) + 0.5f), polygon.nearness.b);
  }
}

void CoarseDepth::finish() {
  if (lastRow_ < firstRow_) return;
  // Each cell takes the least of its samples and of those one further out on every side, as far as there are any: a
  // thing that shows past an occluder's edge by less than a sample counts as seen. Columns first, then rows.
  for (int row = firstRow_; row <= lastRow_; ++row) {
    const Nearness* const line = samples_.data() + static_cast<std::size_t>(row) * kSamples;
    Nearness* const out = narrowed_.data() + static_cast<std::size_t>(row) * kSide;
    for (int column = 0; column < kSide; ++column) {
      const int begin = std::max(column * kEach - 1, 0), end = std::min((column + 1) * kEach + 1, kSamples);
      Nearness least = line[begin];
      for (int x = begin + 1; x < end; ++x) least = std::min(least, line[x]);
      out[column] = least;
    }
  }
  for (int cell = firstRow_ / kEach; cell <= lastRow_ / kEach; ++cell) {
    const int begin = std::max(cell * kEach - 1, 0), end = std::min((cell + 1) * kEach + 1, kSamples);
    if (begin < firstRow_ || end - 1 > lastRow_) continue;  // rows without any occluder
    Nearness* const out = cells_.data() + static_cast<std::size_t>(cell) * kSide;
    std::copy_n(narrowed_.data() + static_cast<std::size_t>(begin) * kSide, kSide, out);
    for (int row = begin + 1; row < end; ++row) {
      const Nearness* const line = narrowed_.data() + static_cast<std::size_t>(row) * kSide;
      for (int column = 0; column < kSide; ++column) out[column] = std::min(out[column], line[column]);
    }
  }
}

bool CoarseDepth::hides(const Contour& contour, double reach) const {
  if (drawn_ == 0) return false;
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-std::numeric_limits<double>::infinity());
  double nearest = std::numeric_limits<double>::infinity();
  const glm::dvec3 toCentre = contour.centre - projection_.eye;
  std::array<glm::dvec3, 3> half;
  for (std::size_t a = 0; a < 3; ++a) half[a] = contour.axis[a] * contour.half[a];
  const double perX = static_cast<double>(kSide) / view_.width, perY = static_cast<double>(kSide) / view_.height;
  const double margin = reach * std::sqrt(3.0);
  for (int corner = 0; corner < 8; ++corner) {
    glm::dvec3 d = toCentre;
    for (std::size_t a = 0; a < 3; ++a) d += (corner >> a & 1) != 0 ? half[a] : -half[a];
    const glm::dvec4 point(d, 1.0);
    const double depth = glm::dot(projection_.rowDepth, point) - margin;
    if (depth <= view_.nearPlane) return false;
    nearest = std::min(nearest, depth);
    const double w = glm::dot(projection_.rowW, point);
    const glm::dvec2 at(glm::dot(projection_.rowX, point) / w, glm::dot(projection_.rowY, point) / w);
    // A ball of radius m around (x, z) reaches at most m / (z - m) (1 + x / z) further on the screen.
    double grown = margin * pixelsPerMetre_;
    if (!view_.orthographic) {
      const glm::dvec2 fromMiddle = glm::abs(at - 0.5 * glm::dvec2(view_.width, view_.height)) / pixelsPerMetre_;
      grown *= (1.0 + std::max(fromMiddle.x, fromMiddle.y)) / depth;
    }
    low = glm::min(low, (at - grown) * glm::dvec2(perX, perY));
    high = glm::max(high, (at + grown) * glm::dvec2(perX, perY));
  }
  const auto cellOf = [](double along) { return static_cast<int>(std::clamp(std::floor(along), 0.0, kSide - 1.0)); };
  const CellRect rect{cellOf(low.x), cellOf(high.x), cellOf(low.y), cellOf(high.y)};
  return isBehind(rect, facesOf(contour, reach), nearnessOf(nearest));
}

CoarseDepth::BoxFaces CoarseDepth::facesOf(const Contour& contour, double reach) const {
  BoxFaces faces;
  const glm::dvec3 toCentre = contour.centre - view_.eye;
  const double stepX = static_cast<double>(view_.width) / kSide, stepY = static_cast<double>(view_.height) / kSide;
  for (std::size_t a = 0; a < 3; ++a) {
    glm::dvec3 axis = contour.axis[a];
    if (contour.half[a] == 0.0) axis = glm::cross(contour.axis[(a + 1) % 3], contour.axis[(a + 2) % 3]);
    if (!(glm::dot(axis, axis) > 0.5)) continue;  // a line or a point has no such faces; its others suffice
    for (const double sign : {-1.0, 1.0}) {
      const glm::dvec3 outwards = axis * sign;
      const double along = glm::dot(outwards, toCentre) + contour.half[a] + reach;
      Linear nearness;
      if (!linearNearness(outwards, along, stepX, stepY, nearness)) continue;
      const bool towardsEye = view_.orthographic ? glm::dot(outwards, basis_.forward) < 0.0 : along < 0.0;
      // The largest value in the cell where rays enter and the least where they leave: the box may only grow.
      const float spread = 0.5f * (std::abs(nearness.b) + std::abs(nearness.c));
      nearness.a += 0.5f * (nearness.b + nearness.c) + (towardsEye ? spread : -spread);
      if (towardsEye)
        faces.entry[faces.entries++] = nearness;
      else
        faces.exit[faces.exits++] = nearness;
    }
  }
  return faces;
}

bool CoarseDepth::isBehind(const CellRect& rect, const BoxFaces& faces, Nearness nearest) const {
  std::array<Nearness, kSide> enters, leaves;
  const int width = rect.right - rect.left + 1;
  for (int row = rect.top; row <= rect.bottom; ++row) {
    std::fill_n(enters.begin(), width, nearest);
    std::fill_n(leaves.begin(), width, open_);
    for (std::size_t i = 0; i < faces.entries; ++i) {
      const float b = faces.entry[i].b;
      const float start = faces.entry[i].at(static_cast<float>(rect.left), static_cast<float>(row));
      for (int x = 0; x < width; ++x)
        enters[static_cast<std::size_t>(x)] =
            std::min(enters[static_cast<std::size_t>(x)], start + b * static_cast<float>(x));
    }
    for (std::size_t i = 0; i < faces.exits; ++i) {
      const float b = faces.exit[i].b;
      const float start = faces.exit[i].at(static_cast<float>(rect.left), static_cast<float>(row));
      for (int x = 0; x < width; ++x)
        leaves[static_cast<std::size_t>(x)] =
            std::max(leaves[static_cast<std::size_t>(x)], start + b * static_cast<float>(x));
    }
    const Nearness* const line = cells_.data() + static_cast<std::size_t>(row) * kSide + rect.left;
    int seen = 0;
    for (int x = 0; x < width; ++x) {
      const Nearness enter = enters[static_cast<std::size_t>(x)];
      const Nearness margin = kBehind * std::abs(enter);
      seen += static_cast<int>(line[x] <= enter + margin) &
              static_cast<int>(enter + margin >= leaves[static_cast<std::size_t>(x)] - margin);
    }
    if (seen > 0) return false;
  }
  return true;
}

double CoarseDepth::depth(int column, int row) const {
  const Nearness nearness = cells_[static_cast<std::size_t>(row * kSide + column)];
  if (nearness <= open_) return std::numeric_limits<double>::infinity();
  return view_.orthographic ? -static_cast<double>(nearness) : 1.0 / static_cast<double>(nearness);
}

}  // namespace strata
