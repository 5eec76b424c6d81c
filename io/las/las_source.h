#pragma once
#include <memory>
#include <string>

#include "io/file/byte_source.h"
#include "io/las/las_header.h"
#include "io/scan/point_source.h"

namespace strata {

/// A LAS, LAZ or COPC file. Throws Error when it cannot be read; a file of no points is none. Positions come out
/// as integer * scale; attributes as lasLayout (io/las/las_record.h) orders them. Its readers must not outlive it.
std::unique_ptr<PointSource> openLas(const std::string& path, const SourceOptions& options);

/// What openLas does for a LAZ file once its head is read; `info` is complete but for counts.
std::unique_ptr<PointSource> openLaz(std::unique_ptr<ByteSource> file, const LasHead& head, SourceInfo info,
                                     const SourceOptions& options);

}  // namespace strata
