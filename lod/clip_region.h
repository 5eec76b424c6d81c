#pragma once
#include "core/draw_options.h"
#include "lod/contour.h"

namespace strata {

inline bool operator==(const Box& a, const Box& b) { return a.min == b.min && a.max == b.max; }
inline bool operator==(const Clip& a, const Clip& b) {
  return a.boxes == b.boxes && a.cutouts == b.cutouts && a.planes == b.planes;
}

/// False only when of a node with this contour, and of all below it (they lie within `reach` metres around), nothing is
/// drawn with that clip region, at any precision. Boxes are told apart along their own axes and the contour's.
bool mayBeLeftBy(const Clip& clip, const Contour& contour, double reach);

}  // namespace strata
