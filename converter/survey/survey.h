#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "converter/options.h"
#include "converter/survey/measure_extent.h"
#include "io/scan/point_source.h"
#include "io/store/store.h"

namespace strata {

/// How one source's points become points of the store.
struct SourceMapping {
  struct Column {
    std::size_t from, to, bytes;  ///< offsets in the source's and the store's record
  };
  std::vector<Column> columns;
  bool sameLayout = false;       ///< records can be copied whole
  glm::dvec3 originDelta{0.0};   ///< source origin - store grid offset
  int colourShiftAt = -1;        ///< offset in the store's record of attribute::kColourShift, or -1
  std::uint8_t colourShift = 0;  ///< of this source
};

/// The frame of the conversion, known before points are read (design section 5, stage 1).
struct Survey {
  StoreGrid grid;
  int cubeBits = 0;
  PointLayout layout;
  std::string crs;
  std::optional<LasMeta> las;
  std::uint64_t claimedPoints = 0;
  std::vector<SourceMapping> mappings;  ///< one a source
};

/// 0 where the first points of a source keep colours of 0 to 255 in their 16-bit fields, 8 where they use all 16
/// bits, nothing where all are black or there are none.
std::optional<std::uint8_t> sampleColourShift(const PointSource& source);

/// Decides grid, cube and layout. `measured` has an entry for each source, used where present (else the header's
/// bounds are believed). Throws Error for what cannot be converted.
Survey survey(const std::vector<std::unique_ptr<PointSource>>& sources,
              const std::vector<std::optional<MeasuredSource>>& measured);

/// True when the header's bounds of the source can be used as they are.
bool headerBoundsUsable(const SourceInfo& info);

}  // namespace strata
