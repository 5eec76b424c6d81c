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

/// A point that is seen: where in the render list it stands.
struct DrawnPoint {
  std::size_t item = 0;     ///< of RenderList::items
  std::uint32_t point = 0;  ///< in the node's level order
};

/// The pixel that a click at `pixel` means: that one where a point is drawn there, else the nearest with one within
/// `reach` pixels (the one nearer to the eye of two as near to the pixel).
std::optional<glm::ivec2> drawnPixelAt(const Picture& frame, const glm::dvec2& pixel, int reach);

/// The point that is seen there, taken from the visibility buffer, so never one that is hidden. `frame` must have been
/// drawn from `list`.
std::optional<DrawnPoint> drawnPointAt(const RenderList& list, const Picture& frame, const glm::dvec2& pixel,
                                       int reach);

/// A point as its source has it.
struct PickedPoint {
  glm::dvec3 position{0.0};  ///< exactly on the store's grid
  std::string coordinates;   ///< "630123.456 4850123.456 12.345", every digit the grid has
  std::vector<std::pair<std::string, std::string>> facts;  ///< attributes by name, node, source
};

/// Reads the node from the store to tell all about one of its points. Takes milliseconds and waits for the disk.
/// `drawnAt` is where the point was drawn: it tells nodes of the same key apart. Throws Error.
PickedPoint lookUpPoint(const Store& store, NodeKey node, std::uint32_t point, const glm::dvec3& drawnAt);

/// The value of an attribute of one record, as people read it: "52300 51200 49000", "2.5".
std::string attributeText(const Attribute& attribute, const std::byte* value);

/// With as many digits behind the point as steps of `step` need, at most 9.
std::string gridNumber(double value, double step);

}  // namespace strata
