#pragma once
#include <bitset>

#include "core/box.h"
#include "core/view.h"
#include "viewer/tools/clip_boxes.h"

namespace strata {

// The sections "Clip" and "Classes" of the panel "Tools", and the clip boxes over the picture; between
// Window::beginFrame() and finishFrame().

/// Draws the clip boxes with their names and corners, and a button that puts a new one in the middle of `view`. True
/// when something was changed that the picture shows.
bool drawClipSection(ClipTool& tool, const View& view, const Box& bounds);

/// Draws a check box and a colour for every class that is present. True when a class was switched on or off.
bool drawClassSection(const std::bitset<256>& present, std::bitset<256>& shown);

/// Draws the edges and handles of the boxes that are switched on.
void drawClipBoxes(const ClipTool& tool, const View& view);

}  // namespace strata
