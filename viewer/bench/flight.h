#pragma once
#include <memory>

#include "core/draw_options.h"
#include "io/store/store.h"
#include "render/rasterizer.h"
#include "viewer/bench/bench_options.h"
#include "viewer/bench/report.h"

namespace strata {

/// Flies options.path options.repeat times, each time from empty caches, and adds the flights to the report: the median
/// of each measure, and the frames of the typical flight. Pictures and film are taken in the first flight alone, so
/// that the others have nothing to do but fly. Throws Error when the path cannot be read or a file cannot be written.
void flyPath(const BenchOptions& options, const std::shared_ptr<const Store>& store, Rasterizer& rasterizer,
             const DrawOptions& draw, BenchReport& report);

}  // namespace strata
