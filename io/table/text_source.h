#pragma once
#include <memory>
#include <string>

#include "io/scan/point_source.h"

namespace strata {

/// Opens a text scan (xyz, pts, csv, txt, asc, 3d), whose points are lines of numbers; text_format.h says which layouts
/// are known. The constructor reads the whole file once, on all cores, so that count, bounds and grid are exact.
/// Coordinates of at most nine decimals are on the grid of step 10^-decimals. Colours are kept as they are written
/// (floats of 0..1 as 0..255) and intensity as RecordMapping does: integers of 0..65535 count as u16, other integers
/// (PTS: -2048..2047) as i32, and decimals as f32, or as f64 when they have more than six digits.
std::unique_ptr<PointSource> openText(const std::string& path, const SourceOptions& options);

}  // namespace strata
