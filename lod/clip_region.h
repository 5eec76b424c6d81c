#pragma once
#include "core/draw_options.h"
#include "lod/contour.h"

namespace strata {

/// False only when the clip cuts away every point of a node with this contour and every point below it, which lie
/// within `reach` metres of the contour, at any precision. A box and a contour count as apart when they are so along an
/// axis of either; two that are apart only along other directions may be missed.
bool mayBeLeftBy(const Clip& clip, const Contour& contour, double reach);

}  // namespace strata
