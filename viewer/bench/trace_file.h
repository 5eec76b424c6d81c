#pragma once
#include <string>

#include "lod/trace.h"

namespace strata {

/// The trace event format of chrome://tracing and Perfetto (Google, "Trace Event Format"): complete events ("X") in
/// microseconds since the trace began, a thread for each lane, spans of a lane by their beginning, outer ones first.
std::string traceJson(const Trace& trace, const std::string& program);

}  // namespace strata
