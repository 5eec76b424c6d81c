#include <malloc.h>

#include <exception>

#include "core/program.h"
#include "viewer/window/viewer_app.h"

int main(int argc, char** argv) {
  // Nodes come and go in several threads for hours: their blocks go back to the system instead of leaving holes in
  // heaps.
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
