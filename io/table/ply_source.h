#pragma once
#include <memory>
#include <string>

#include "io/scan/point_source.h"

namespace strata {

/// Opens a PLY file, ascii or binary of either byte order. Its points are the vertices; faces and other elements are
/// passed over. The file is streamed, a binary one in parts of a million points and an ascii one in parts of 32 MB.
/// Coordinates of ascii files are read as decimals, whatever the type of their property, and kept on that grid. Throws
/// Error for a binary file whose vertices have lists, since its records have no fixed size.
std::unique_ptr<PointSource> openPly(const std::string& path, const SourceOptions& options);

}  // namespace strata
