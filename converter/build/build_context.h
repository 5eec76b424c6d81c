#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "converter/build/lod_colour.h"
#include "converter/distribute/packed_points.h"
#include "converter/options.h"
#include "converter/subtree_shape.h"
#include "io/store/store.h"

namespace strata {

/// The context that all node building shares; constant over a conversion.
struct BuildContext {
  StoreInfo info;  ///< layout, grid, cubeBits, colourShift, nodePoints and points are set
  PackedFormat format;
  LodColour lodColour = LodColour::first;
  std::uint64_t pointsAtOnce = 0;  ///< pieces of work that are in memory together have no more points, or are one piece

  /// True when nodes with children have colours of their own to be drawn in.
  bool averages() const { return lodColour == LodColour::average && info.layout.find(attribute::kRgb) >= 0; }
  /// Bytes of a point of a top: its packed record and, where colours are averaged, its Represented.
  std::size_t topPointStride() const { return format.stride() + (averages() ? sizeof(Represented) : 0); }
  glm::dvec3 position(const std::int64_t (&grid)[3]) const {
    return info.grid.offset + info.grid.scale * glm::dvec3(grid[0], grid[1], grid[2]);
  }
};

/// How grid integers become the local integers of a cell: they count from its corner and are halved until 31 bits hold
/// them.
struct CellCoordinates {
  CellCoordinates(const BuildContext& context, NodeKey cell);

  std::int64_t inside;   ///< mask of the bits below the cell's corner
  int bits;              ///< the cell spans 2^bits local integers
  int shift;             ///< local = (grid & inside) >> shift
  glm::dvec3 corner{0};  ///< world
  glm::dvec3 step{1};    ///< metres between two local integers, by axis

  std::int32_t local(std::int64_t grid) const { return static_cast<std::int32_t>((grid & inside) >> shift); }
  /// Turns moments about the corner, as LevelOrder has them, into world coordinates.
  Moments world(Moments moments) const {
    moments.mean += corner;
    return moments;
  }
};

}  // namespace strata
