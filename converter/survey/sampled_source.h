#pragma once
#include <memory>
#include <vector>

#include "io/scan/point_source.h"

namespace strata {

/// About `points` points out of all sources, taken from the beginnings of parts that are spread evenly over them; one
/// sampled source for each that has any. The sources must outlive what is returned.
std::vector<std::unique_ptr<PointSource>> sampleSources(const std::vector<std::unique_ptr<PointSource>>& sources,
                                                        std::uint64_t points);

}  // namespace strata
