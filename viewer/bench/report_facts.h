#pragma once
#include <string>
#include <utility>
#include <vector>

#include "core/draw_options.h"
#include "io/store/store.h"
#include "viewer/bench/bench_options.h"

namespace strata {

/// Lines of a report, each a name and a text to be read.
using Facts = std::vector<std::pair<std::string, std::string>>;

/// The name of a store for people: "city" for "/data/city.strata/".
std::string storeName(const std::string& path);
Facts storeFacts(const Store& store);
/// Describes how a run was measured. `pageCache` says what was done with the system's page cache before it.
Facts optionFacts(const BenchOptions& options, const DrawOptions& draw, const std::string& pageCache);

}  // namespace strata
