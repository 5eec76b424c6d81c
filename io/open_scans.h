#pragma once
#include <memory>
#include <string>
#include <vector>

#include "io/scan/point_source.h"

namespace strata {

/// Every scan that `inputs` names (files, folders, `synthetic:NAME?points=1e6&seed=1`), in a fixed order
/// (folders sorted by name, searched recursively). Throws Error for the first input that cannot be a scan.
std::vector<std::unique_ptr<PointSource>> openScans(const std::vector<std::string>& inputs,
                                                    const SourceOptions& options);

}  // namespace strata
