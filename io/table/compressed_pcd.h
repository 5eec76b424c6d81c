#pragma once
#include <cstdint>
#include <memory>

#include "io/file/byte_source.h"
#include "io/scan/point_source.h"
#include "io/table/pcd_header.h"

namespace strata {

/// Opens a binary_compressed PCD file, which PCL's LZF decoder unpacks. Such a file has all values of one field before
/// those of the next, so a reader holds the whole file unpacked while it is open; the source itself holds nothing.
/// Throws Error when the unpacked file would take more than `memoryBytes`. There is one part, and the bounds are exact.
std::unique_ptr<PointSource> openCompressedPcd(std::unique_ptr<ByteSource> bytes, const PcdHeader& header,
                                               std::uint64_t memoryBytes);

}  // namespace strata
