#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "converter/survey/measure_extent.h"
#include "io/scan/point_source.h"
#include "io/store/store.h"

namespace strata {

/// How one source's points become points of the store.
struct SourceMapping {
  struct Column {
    std::size_t from, to, bytes;  ///< offsets in the source's and in the store's attribute record
  };
  std::vector<Column> columns;
  bool sameLayout = false;       ///< attribute records can be copied whole
  glm::dvec3 originDelta{0.0};   ///< source origin - store grid offset, metres
  int colourShiftAt = -1;        ///< offset in the store's attribute record of attribute::kColourShift, or -1
  std::uint8_t colourShift = 0;  ///< the value of that attribute for every point of the source
};

/// Everything that is decided before points are read.
struct Survey {
  StoreGrid grid;
  int cubeBits = 0;  ///< the cube spans 2^cubeBits steps of the grid
  PointLayout layout;
  std::string crs;
  std::optional<LasMeta> las;
  std::uint64_t claimedPoints = 0;      ///< as the headers say
  std::vector<SourceMapping> mappings;  ///< by source
};

/// Returns 0 where the first points of a source keep colours of 0 to 255 in their 16-bit fields, 8 where they use all
/// 16 bits, and nothing where all of them are black or there are none. Throws Error.
std::optional<std::uint8_t> sampleColourShift(const PointSource& source);

/// Decides grid, cube and layout from the headers, and from `measured` where it has an extent of the source. Throws
/// Error for scans that cannot be converted.
Survey survey(const Sources& sources, const MeasuredExtents& measured);

}  // namespace strata
