#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/box.h"
#include "core/point_layout.h"
#include "io/store/las_meta.h"

namespace strata {

/// The version of the store format that this program writes, and the only one that it reads.
inline constexpr int kStoreVersion = 2;

/// The range of an attribute's values over all points, and over all components of a vector together.
struct AttributeRange {
  double min = 0.0;
  double max = 0.0;
  double low = 0.0;   ///< 1st percentile, drawn as black; equal to `min` where percentiles were not gathered
  double high = 0.0;  ///< 99th percentile, drawn as white; else `max`
};

/// One input of the conversion.
struct StoreSource {
  std::string path;
  std::string format;
  std::uint64_t points = 0;
  std::uint64_t skipped = 0;  ///< points left out: not finite, or lost to damage that the user accepted
};

/// The grid that positions are kept on: world = offset + scale * integer, with integers from 0 on.
struct StoreGrid {
  glm::dvec3 scale{0.001};
  glm::dvec3 offset{0.0};
  bool exact = true;  ///< every source coordinate lies on the grid; otherwise within half a step of it
};

/// The contents of store.json, which docs/format.md describes.
struct StoreInfo {
  int version = kStoreVersion;
  std::string program;  ///< "strata 0.1.0"
  std::uint64_t points = 0;
  std::uint64_t nodes = 0;
  int levels = 0;  ///< the level of the deepest node, plus 1
  Box bounds;      ///< of the points, world
  StoreGrid grid;
  int cubeBits = 0;  ///< the root's cube is 2^cubeBits grid steps along each axis, from integer 0 on
  std::string crs;
  PointLayout layout;
  std::vector<AttributeRange> ranges;  ///< one for each attribute of the layout
  int colourShift = 0;           ///< drawn colour = rgb >> colourShift: 8, or 0 for sources with 0..255 in 16 bits
  std::uint32_t nodePoints = 0;  ///< points of a node that the conversion aimed at
  std::string sampling;
  std::uint64_t skipped = 0;
  std::vector<StoreSource> sources;
  std::optional<LasMeta> las;  ///< from the first LAS source, for exports

  Box rootCube() const;
};

/// The text of store.json.
std::string storeInfoJson(const StoreInfo& info);
/// The inverse of storeInfoJson(). Throws Error that names `path` and says what is wrong.
StoreInfo parseStoreInfo(const std::string& path, const std::string& json);

}  // namespace strata
