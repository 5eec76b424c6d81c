#pragma once
#include <cstdint>
#include <memory>

#include "io/file/byte_source.h"
#include "io/scan/point_source.h"
#include "io/table/pcd_header.h"

namespace strata {

/// The points of a binary_compressed PCD file. PCL's LZF decoder unpacks it; as the columns stand one after the other,
/// it has to be held whole while a reader is open (the source itself holds nothing). Throws Error where that takes more
/// than `memoryBytes`. One part; bounds are exact.
std::unique_ptr<PointSource> openCompressedPcd(std::unique_ptr<ByteSource> bytes, const PcdHeader& header,
                                               std::uint64_t memoryBytes);

}  // namespace strata
