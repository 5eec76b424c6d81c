#pragma once
#include "viewer/window/viewer_options.h"

namespace strata {

/// Replaces every scan among `options.stores` by the store beside it. For a scan that has none a window opens, asks
/// whether and where to convert it, and shows the progress and the reason of a failure. With `options.convert` it does
/// not ask, and throws Error for a conversion that fails. False when the user does not want to convert.
bool convertScans(ViewerOptions& options);

}  // namespace strata
