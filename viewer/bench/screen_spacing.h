#pragma once
#include "core/picture.h"
#include "core/render_list.h"
#include "core/view.h"
#include "io/store/store.h"
#include "lod/hierarchy_index.h"

namespace strata {

/// The widest distance in pixels between neighbouring points of a picture, wherever the store has more points than are
/// drawn: in nodes that are drawn in part, and in children in view of drawn nodes that are not drawn themselves. The
/// distance is 1 / sqrt(points drawn per square metre), projected to the screen as selectNodes() does. Nodes that the
/// picture hides, or that are smaller than a pixel, do not count. With full detail, no occlusion test and a sufficient
/// point budget the result is at most 1 / sqrt(pointsPerPixel), apart from rounding to whole points. It is 0 when
/// nothing is drawn or when the store has no more points.
double widestSpacing(const Hierarchy& hierarchy, const HierarchyIndex& index, const RenderList& list, const View& view,
                     const Picture& picture);

}  // namespace strata
