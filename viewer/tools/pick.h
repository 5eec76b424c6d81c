#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "core/picture.h"
#include "core/render_list.h"
#include "io/store/store.h"

namespace strata {

/// A point that is seen in a picture.
struct DrawnPoint {
  std::size_t item = 0;     ///< index in RenderList::items
  std::uint32_t point = 0;  ///< in the node's level order
};

/// The nearest pixel to `pixel` in which a point is drawn, within `reach` pixels. Of two that are equally near, it is
/// the one whose point is nearer to the eye.
std::optional<glm::ivec2> drawnPixelAt(const Picture& picture, const glm::dvec2& pixel, int reach);

/// The point that drawnPixelAt() finds. It comes from the point ids of `picture`, which must have been drawn from
/// `list`, so it is never a hidden one.
std::optional<DrawnPoint> drawnPointAt(const RenderList& list, const Picture& picture, const glm::dvec2& pixel,
                                       int reach);

/// A point with the values that its source has.
struct PickedPoint {
  glm::dvec3 position{0.0};  ///< exactly on the store's grid
  std::string coordinates;   ///< "630123.456 4850123.456 12.345", with every digit of the grid
  std::vector<std::pair<std::string, std::string>> facts;  ///< attributes by name, node, source
};

/// Reads the node of record `index` in the store's hierarchy and describes its point number `point`. This takes
/// milliseconds and waits for the disk. Throws Error.
PickedPoint lookUpPoint(const Store& store, std::uint32_t index, std::uint32_t point);

/// The value of an attribute in one attribute record, as people read it: "52300 51200 49000", "2.5".
std::string attributeText(const Attribute& attribute, const std::byte* value);

/// `value` with the decimals that steps of `step` need, at most 9.
std::string gridNumber(double value, double step);

}  // namespace strata
