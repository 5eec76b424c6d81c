#include "converter/survey/measure_extent.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/gtx/component_wise.hpp>
#include <map>

#include "core/mutex.h"

namespace strata {
namespace {

constexpr std::size_t kMeasureBlock = 65536;  // points
constexpr std::size_t kSampleEvery = 101;     // every so many points one counts for the percentiles
constexpr std::uint64_t kMostSamples = 500000;

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// The longest side of the box that leaves out a hundredth of the points at either end of each axis.
double typicalExtent(std::vector<glm::dvec3> points) {
  double longest = 0.0;
  std::vector<double> along(points.size());
  for (int axis = 0; axis < 3 && !points.empty(); ++axis) {
    std::transform(points.begin(), points.end(), along.begin(), [axis](const glm::dvec3& p) { return p[axis]; });
    const auto hundredth = static_cast<std::ptrdiff_t>(along.size() / 100);
    std::nth_element(along.begin(), along.begin() + hundredth, along.end());
    const double low = along[static_cast<std::size_t>(hundredth)];
    std::nth_element(along.begin(), along.end() - 1 - hundredth, along.end());
    longest = std::max(longest, *(along.end() - 1 - hundredth) - low);
  }
  return longest;
}

MeasuredExtent measureExtent(const PointSource& source, int threads, const ConvertControl& control) {
  MeasuredExtent result;
  std::map<int, std::uint64_t> magnitudes;
  std::vector<glm::dvec3> sample;
  Mutex mutex;
  std::atomic<std::uint64_t> done{0};
  const std::size_t sampleEvery = std::max<std::uint64_t>(kSampleEvery, source.info().pointCount / kMostSamples | 1);
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, source.partCount(), [&](std::size_t part) {
      PointBlock block;
      Box bounds;
      std::map<int, std::uint64_t> exponents;
      std::vector<glm::dvec3> sampleHere;
      std::size_t seen = 0;
      const auto reader = source.openPart(part);
      while (reader->read(block, kMeasureBlock)) {
        control.checkStop();
        for (const glm::dvec3& p : block.positions) {
          if (!finite(p)) continue;
          bounds.add(p);
          if (seen++ % sampleEvery == 0) sampleHere.push_back(p);
          // The origin lies on every grid; scanners write it for rays that met nothing.
          if (const double magnitude = glm::compMax(glm::abs(p)); magnitude > 0.0) ++exponents[std::ilogb(magnitude)];
        }
        control.progress({stage::kMeasure, done += block.count(), source.info().pointCount});
      }
      const MutexLock lock(mutex);
      result.bounds.add(bounds);
      sample.insert(sample.end(), sampleHere.begin(), sampleHere.end());
      for (const auto& [exponent, count] : exponents) magnitudes[exponent] += count;
    });
  });
  result.typicalExtent = typicalExtent(std::move(sample));
  // The median of the magnitudes, from their histogram.
  std::uint64_t total = 0, before = 0;
  for (const auto& [exponent, count] : magnitudes) total += count;
  for (const auto& [exponent, count] : magnitudes) {
    before += count;
    if (2 * before >= total) {
      result.typicalMagnitude = std::ldexp(1.0, exponent);
      break;
    }
  }
  return result;
}

}  // namespace

bool headerBoundsUsable(const SourceInfo& info) {
  if (!info.gridExact || info.bounds.empty() || !finite(info.bounds.min) || !finite(info.bounds.max)) return false;
  if (!info.las) return true;
  for (int axis = 0; axis < 3; ++axis)  // a LAS coordinate is a 32-bit integer
    for (const double edge : {info.bounds.min[axis], info.bounds.max[axis]})
      if (std::abs((edge - info.origin[axis]) / info.step[axis]) > 2147483649.0) return false;
  return true;
}

MeasuredExtents measureExtents(const Sources& sources, bool all, int threads, const ConvertControl& control) {
  MeasuredExtents out{std::vector<std::optional<MeasuredExtent>>(sources.size()), all};
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (sources[i]->info().pointCount == 0)
      out.sources[i] = MeasuredExtent{};
    else if (all || !headerBoundsUsable(sources[i]->info()))
      out.sources[i] = measureExtent(*sources[i], threads, control);
  return out;
}

}  // namespace strata
