#pragma once
#include <memory>

#include "io/store/store.h"
#include "viewer/bench/bench_options.h"
#include "viewer/bench/report.h"

namespace strata {

/// Plays the path and takes the stills that `options` ask for, writes pictures and report into options.output and
/// returns the report. Throws Error for what cannot be read or written.
///
/// The first view is loaded to full detail and drawn once before the flight begins; the time for the former is
/// time_to_full_detail_ms. The flight then runs in real time: frame k is not begun before k / fps seconds, a frame
/// that takes longer delays the ones after it, and none is left out. Pictures are encoded between frames, not in them.
BenchReport runBench(const BenchOptions& options);

}  // namespace strata
