#include "converter/survey/survey.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <glm/gtx/component_wise.hpp>

#include "core/error.h"

namespace strata {
namespace {

constexpr int kMostCubeBits = 52;        // integers that a double holds exactly
constexpr double kCoarsestShare = 1e-7;  // of the typical extent: steps grow no further for the sake of far outliers
constexpr double kGridTolerance = 1e-4;  // of a step: what decimal scale factors lose in binary

bool isWhole(double value) { return std::abs(value - std::round(value)) <= kGridTolerance; }

/// The steps of one axis over all sources.
struct AxisGrid {
  double step = 0.0;
  double anchor = 0.0;  ///< a coordinate on the grid
  bool exact = true;
};

/// A step that divides every source's step and the distances between their origins, if a decimal one does.
AxisGrid commonGrid(const Sources& sources, const std::vector<glm::dvec3>& steps, int axis) {
  AxisGrid grid;
  grid.anchor = sources.front()->info().origin[axis];
  double finest = steps.front()[axis];
  for (const glm::dvec3& s : steps) finest = std::min(finest, s[axis]);
  const auto fits = [&](double step) {
    for (std::size_t i = 0; i < sources.size(); ++i)
      if (!isWhole(steps[i][axis] / step) || !isWhole((sources[i]->info().origin[axis] - grid.anchor) / step))
        return false;
    return true;
  };
  for (const double divisor : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 1000.0}) {
    grid.step = finest / divisor;
    if (fits(grid.step)) return grid;
  }
  grid.step = finest / 16.0;  // close enough to round back to each source's own integers
  grid.exact = false;
  return grid;
}

/// Makes the steps of the three axes alike by dividing the coarser ones by whole numbers, so that node cubes are
/// nearly cubes in metres as well.
void evenOut(AxisGrid (&axes)[3]) {
  const double finest = std::min({axes[0].step, axes[1].step, axes[2].step});
  for (AxisGrid& axis : axes) axis.step /= std::max(1.0, std::round(axis.step / finest));
}

/// The largest power of ten that is not above the value.
double powerOfTenBelow(double value) { return std::pow(10.0, std::floor(std::log10(value))); }

std::string shortNumber(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// The size of the last digit that most points' floats can tell: far outliers, whose floats are coarser, do not count.
double typicalStep(const SourceInfo& info, const MeasuredExtent& measured) {
  const double ulp = measured.typicalMagnitude * std::ldexp(1.0, info.float64 ? -52 : -23);
  if (!info.float64) return powerOfTenBelow(0.5 * ulp);
  return powerOfTenBelow(std::max({ulp, measured.typicalExtent * 1e-9, 1e-9}));
}

/// The step of a source: its own, or for floats what most of its points can resolve.
glm::dvec3 sourceStep(const SourceInfo& info, const std::optional<MeasuredExtent>& measured) {
  if (info.gridExact) return info.step;
  glm::dvec3 step = info.step;
  if (measured && measured->typicalMagnitude > 0.0)
    for (int axis = 0; axis < 3; ++axis) {
      const double typical = typicalStep(info, *measured);
      step[axis] = step[axis] > 0.0 ? std::min(step[axis], typical) : typical;
    }
  const double extent = glm::compMax(measured ? measured->bounds.size() : info.bounds.size());
  const double coarsest = measured ? measured->typicalExtent * kCoarsestShare : 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(step[axis] > 0.0)) step[axis] = extent > 0.0 ? powerOfTenBelow(extent * 1e-9) : 1e-6;
    while (extent / step[axis] > std::ldexp(1.0, kMostCubeBits - 1) && step[axis] < coarsest) step[axis] *= 10.0;
  }
  return step;
}

Box sourceBounds(const PointSource& source, const std::optional<MeasuredExtent>& measured) {
  if (!measured) return source.info().bounds;
  Box box = measured->bounds;
  if (!box.empty()) {
    box.min += source.info().origin;
    box.max += source.info().origin;
  }
  return box;
}

PointLayout unitedLayout(const Sources& sources) {
  std::vector<Attribute> united;
  for (const auto& source : sources)
    for (const Attribute& a : source->info().layout.attributes()) {
      const auto same =
          std::find_if(united.begin(), united.end(), [&](const Attribute& u) { return u.name == a.name; });
      if (same == united.end())
        united.push_back(a);
      else if (same->type != a.type || same->components != a.components)
        throw Error(source->info().path,
                    "attribute '" + a.name + "' has another type than in the files before, found " +
                        std::string(scalarName(a.type)) + " x " + std::to_string(a.components) + " (expected " +
                        std::string(scalarName(same->type)) + " x " + std::to_string(same->components) + ")");
    }
  return PointLayout(std::move(united));
}

SourceMapping mapLayout(const PointLayout& from, const PointLayout& to) {
  SourceMapping mapping;
  mapping.sameLayout = from.stride() == to.stride();
  for (std::size_t i = 0; i < from.attributes().size(); ++i) {
    const int target = to.find(from.attributes()[i].name);
    const std::size_t offset = to.offset(static_cast<std::size_t>(target));
    mapping.columns.push_back({from.offset(i), offset, from.attributes()[i].bytes()});
    mapping.sameLayout = mapping.sameLayout && from.offset(i) == offset;
  }
  return mapping;
}

/// `widest` names the source to blame where the points do not fit one grid.
void placeCube(const std::string& widest, const Box& bounds, const AxisGrid (&axes)[3], Survey& out) {
  std::uint64_t steps = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const AxisGrid& grid = axes[axis];
    const double first = std::floor((bounds.min[axis] - grid.anchor) / grid.step + kGridTolerance);
    const double last = std::ceil((bounds.max[axis] - grid.anchor) / grid.step - kGridTolerance);
    if (!(last - first < std::ldexp(1.0, kMostCubeBits)))
      throw Error(widest, "points lie too far apart for one grid, found " + shortNumber(last - first) + " steps of " +
                              shortNumber(grid.step) + " m (expected less than 2^52); take out those that lie far off");
    out.grid.scale[axis] = grid.step;
    out.grid.offset[axis] = grid.anchor + first * grid.step;
    out.grid.exact = out.grid.exact && grid.exact;
    steps = std::max(steps, static_cast<std::uint64_t>(last - first) + 1);
  }
  out.cubeBits = static_cast<int>(std::bit_width(steps - 1));
}

/// Sources that write colours in different ways need the way kept with every point.
void mapColours(const Sources& sources, Survey& out) {
  std::vector<std::uint8_t> shifts;
  bool differ = false;
  for (const auto& source : sources) {
    const std::optional<std::uint8_t> shift = sampleColourShift(*source);
    const std::uint8_t before = shifts.empty() ? shift.value_or(8) : shifts.back();
    shifts.push_back(shift.value_or(before));
    differ = differ || shifts.back() != shifts.front();
  }
  if (!differ) return;
  std::vector<Attribute> attributes = out.layout.attributes();
  attributes.push_back({std::string(attribute::kColourShift), ScalarType::u8, 1, "", 1.0, 0.0});
  out.layout = PointLayout(std::move(attributes));
  for (std::size_t i = 0; i < sources.size(); ++i) {
    SourceMapping& mapping = out.mappings[i];
    mapping.colourShift = shifts[i];
    mapping.colourShiftAt = static_cast<int>(out.layout.offset(out.layout.attributes().size() - 1));
    mapping.sameLayout = false;
  }
}

}  // namespace

std::optional<std::uint8_t> sampleColourShift(const PointSource& source) {
  constexpr std::size_t kSample = 20000;
  const PointLayout& layout = source.info().layout;
  const int rgb = layout.find(attribute::kRgb);
  if (rgb < 0 || source.partCount() == 0) return std::nullopt;
  PointBlock block;
  if (!source.openPart(0)->read(block, kSample)) return std::nullopt;
  std::uint16_t largest = 0;
  for (std::size_t i = 0; i < block.count(); ++i) {
    std::uint16_t value[3];
    std::memcpy(value, block.attributes.data() + i * layout.stride() + layout.offset(static_cast<std::size_t>(rgb)),
                sizeof value);
    largest = std::max({largest, value[0], value[1], value[2]});
  }
  if (largest == 0) return std::nullopt;
  return largest > 255 ? 8 : 0;
}

Survey survey(const Sources& sources, const MeasuredExtents& measured) {
  Survey out;
  Box bounds;
  std::vector<glm::dvec3> steps;
  std::string widest = sources.front()->info().path;
  double widestExtent = -1.0;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const SourceInfo& info = sources[i]->info();
    out.claimedPoints += info.pointCount;
    const Box box = sourceBounds(*sources[i], measured.sources[i]);
    if (!box.empty()) bounds.add(box);
    if (!box.empty() && !(glm::compMax(box.size()) <= widestExtent)) {
      widestExtent = glm::compMax(box.size());
      widest = info.path;
    }
    steps.push_back(sourceStep(info, measured.sources[i]));
    out.grid.exact = out.grid.exact && info.gridExact;
    if (out.crs.empty()) out.crs = info.crs;
    if (!out.las && info.las) out.las = info.las;
  }
  if (bounds.empty()) throw Error(sources.front()->info().path, "has no point with finite coordinates");
  AxisGrid axes[3];
  for (int axis = 0; axis < 3; ++axis) axes[axis] = commonGrid(sources, steps, axis);
  evenOut(axes);
  placeCube(widest, bounds, axes, out);
  out.layout = unitedLayout(sources);
  for (const auto& source : sources) {
    SourceMapping mapping = mapLayout(source->info().layout, out.layout);
    mapping.originDelta = source->info().origin - out.grid.offset;
    out.mappings.push_back(std::move(mapping));
  }
  if (sources.size() > 1 && out.layout.find(attribute::kRgb) >= 0) mapColours(sources, out);
  return out;
}

}  // namespace strata
