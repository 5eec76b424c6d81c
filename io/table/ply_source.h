#pragma once
#include <memory>
#include <string>

#include "io/scan/point_source.h"

namespace strata {

/// The vertices of a PLY file, ascii or binary of either byte order; faces and other elements are passed over.
/// Never holds the file whole. Binary files are cut into parts of a million points, ascii files into parts of 32 MB.
/// Refused: lists among the properties of the vertices of a binary file (their records have no fixed size).
/// Ascii coordinates are read as decimals, whatever their property's type, and are kept on that grid.
std::unique_ptr<PointSource> openPly(const std::string& path, const SourceOptions& options);

}  // namespace strata
