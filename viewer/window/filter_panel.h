#pragma once
#include <bitset>

#include "core/box.h"
#include "core/view.h"
#include "viewer/tools/clip_boxes.h"

namespace strata {

/// Clip boxes by name, with their numbers; a new one stands in the middle of the view. True when something was changed
/// that the picture shows.
bool drawClipSection(ClipTool& tool, const View& view, const Box& bounds);

/// A check box and a colour for each class that is present. True when one was switched on or off.
bool drawClassSection(const std::bitset<256>& present, std::bitset<256>& shown);

/// The boxes' edges and handles over the picture.
void drawClipBoxes(const ClipTool& tool, const View& view);

}  // namespace strata
