#include "io/table/record_sample.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "io/table/coordinate_step.h"

namespace strata {
namespace {

constexpr double kPowersOfTen[] = {1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};

/// Raises `decimals` until `value` is integer * 10^-decimals up to rounding, which is two units in its last place or
/// 1e-12, as after computing scale * integer + offset. Digits within that rounding do not count as a grid.
void countDecimals(double value, int& decimals) {
  const double rounding = std::max(std::abs(value) * 4.5e-16, 1e-12);
  for (; decimals < RecordSample::kManyDecimals; ++decimals) {
    if (8.0 * rounding * kPowersOfTen[decimals] > 1.0)
      decimals = RecordSample::kManyDecimals - 1;  // the grid would be finer than the numbers are
    else if (std::abs(std::round(value * kPowersOfTen[decimals]) / kPowersOfTen[decimals] - value) <= rounding)
      return;
  }
}

}  // namespace

void addToSample(RecordSample& sample, const std::vector<Field>& fields, std::span<const std::byte> records,
                 std::size_t recordBytes) {
  const AxisFields axes = findAxes(fields);
  const bool placed = std::all_of(std::begin(axes.index), std::end(axes.index), [](int i) { return i >= 0; });
  for (std::size_t at = 0; at + recordBytes <= records.size(); at += recordBytes) {
    const std::byte* record = records.data() + at;
    for (std::size_t i = 0; i < fields.size(); ++i)
      sample.ranges[i].add(loadScalar(record + fields[i].offset, fields[i].type));
    ++sample.points;
    if (!placed) continue;
    glm::dvec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      const Field& field = fields[static_cast<std::size_t>(axes.index[axis])];
      p[axis] = loadScalar(record + field.offset, field.type);
    }
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) continue;
    sample.bounds.add(p);
    for (int axis = 0; axis < 3; ++axis) countDecimals(p[axis], sample.decimals);
  }
}

void describePositions(const RecordMapping& mapping, const RecordSample& sample, bool complete, SourceInfo& info) {
  info.boundsExact = complete;
  if (complete) info.bounds = sample.bounds;
  if (sample.bounds.empty()) return;
  const bool anyFloat32 = mapping.axis(0).type == ScalarType::f32 || mapping.axis(1).type == ScalarType::f32 ||
                          mapping.axis(2).type == ScalarType::f32;
  if (complete && !anyFloat32 && sample.decimals < RecordSample::kManyDecimals) {
    info.step = glm::dvec3(1.0 / kPowersOfTen[sample.decimals]);
    info.gridExact = true;
    return;
  }
  glm::dvec3 step(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    const double largest = std::max(std::abs(sample.bounds.min[axis]), std::abs(sample.bounds.max[axis]));
    switch (mapping.axis(axis).type) {
      case ScalarType::f32:
        step[axis] = float32Step(largest);
        break;
      case ScalarType::f64:
        step[axis] = float64Step(sample.bounds);
        info.float64 = true;
        break;
      default:
        step[axis] = 1.0;
    }
  }
  info.step = fillSteps(step);
}

}  // namespace strata
