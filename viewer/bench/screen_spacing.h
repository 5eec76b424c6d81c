#pragma once
#include "core/picture.h"
#include "core/render_list.h"
#include "core/view.h"
#include "io/store/store.h"
#include "lod/hierarchy_index.h"

namespace strata {

/// The widest distance in pixels between neighbouring points of a picture that more of the store's points would narrow:
/// over all drawn nodes of which a part is drawn, and all children in view of drawn nodes that are not drawn
/// themselves, 1 / sqrt(points a square metre that are drawn there) on the screen, as selectNodes() reckons both. What
/// the picture hides does not count, nor what is shorter than a pixel. With full detail, no occlusion test and points
/// enough in the budget at most 1 / sqrt(pointsPerPixel), but for rounding to whole points; 0 where nothing is drawn or
/// nothing more is to be had.
double widestSpacing(const Hierarchy& hierarchy, const HierarchyIndex& index, const RenderList& list, const View& view,
                     const Picture& frame);

}  // namespace strata
