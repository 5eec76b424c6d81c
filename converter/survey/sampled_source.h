#pragma once
#include <cstdint>

#include "io/scan/point_source.h"

namespace strata {

/// Returns one source with some of the points of each source that has any, about `points` points in all, taken from the
/// beginnings of parts that are spread evenly over the sources. The sources must outlive what is returned.
Sources sampleSources(const Sources& sources, std::uint64_t points);

}  // namespace strata
