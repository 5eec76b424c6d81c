#pragma once
#include <memory>
#include <string>

#include "io/scan/point_source.h"

namespace strata {

/// Points as lines of numbers: xyz, pts, csv, txt, asc, 3d; see text_format.h for what is understood.
/// The constructor passes over the whole file, with all cores: count, bounds and grid are exact. Coordinates of at most
/// nine decimals make SourceInfo::step 10^-decimals and gridExact.
/// Colours are kept as written (floats of 0..1 as 0..255); intensity as in FieldMap, where integers of 0..65535 count
/// as u16, other integers (PTS: -2048..2047) as i32 and decimals as f32, or f64 where they have more than six digits.
std::unique_ptr<PointSource> openText(const std::string& path, const SourceOptions& options);

}  // namespace strata
