#pragma once
#include <memory>

#include "io/store/store.h"
#include "render/rasterizer.h"
#include "viewer/bench/bench_options.h"
#include "viewer/bench/report.h"

namespace strata {

/// Draws the stills of a store in full detail, writes them into options.output, and puts them before the pictures that
/// the report has already. Throws Error when a node is damaged or a file cannot be written.
void takeStills(const BenchOptions& options, const std::shared_ptr<const Store>& store, Rasterizer& rasterizer,
                BenchReport& report);

}  // namespace strata
