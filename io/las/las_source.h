#pragma once
#include <memory>
#include <string>

#include "io/scan/point_source.h"

namespace strata {

/// Opens a LAS, LAZ or COPC file. Throws Error when it cannot be read; a file without points is no error. Positions are
/// integer * scale, and the attributes have the order of lasLayout() (las_record.h).
std::unique_ptr<PointSource> openLas(const std::string& path, const SourceOptions& options);

}  // namespace strata
