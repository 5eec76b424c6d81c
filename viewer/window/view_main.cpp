#include <malloc.h>

#include <exception>

#include "core/program.h"
#include "viewer/window/viewer_app.h"
#include "viewer/window/viewer_options.h"

int main(int argc, char** argv) {
  // Several threads allocate and free nodes for hours. Blocks of a node's size go back to the system at once instead of
  // leaving holes in the heaps, of which there are no more than two.
  ::mallopt(M_MMAP_THRESHOLD, 1 << 18);
  ::mallopt(M_ARENA_MAX, 2);
  try {
    const auto options = strata::parseViewerOptions(argc, argv);
    if (options) strata::runViewer(*options);
    return 0;
  } catch (const std::exception& error) {
    return strata::reportFailure(error);
  }
}
