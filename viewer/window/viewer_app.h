#pragma once
#include "viewer/window/viewer_options.h"

namespace strata {

/// Runs strata-view: converts scans that have no store yet, then shows the stores until the window is closed, or draws
/// the one picture that was asked for. Throws Error for stores that cannot be opened and where there is no display.
void runViewer(const ViewerOptions& options);

}  // namespace strata
