#pragma once
#include <memory>

#include "io/file/byte_source.h"
#include "io/las/las_header.h"
#include "io/scan/point_source.h"

namespace strata {

/// Opens a LAZ file whose head has been read. `info` is complete except for its counts. A part is about half a million
/// points, or the whole file when it has no chunk table. laz_codec.h decodes the points.
std::unique_ptr<PointSource> openLaz(std::unique_ptr<ByteSource> file, const LasHead& head, SourceInfo info,
                                     const SourceOptions& options);

}  // namespace strata
