#include <malloc.h>

#include "core/program/exit_code.h"
#include "viewer/window/viewer_app.h"
#include "viewer/window/viewer_options.h"

namespace strata {
namespace {

int run(int argc, char** argv) {
  // Several threads allocate and free nodes for hours. Blocks of a node's size go back to the system at once instead of
  // leaving holes in the heaps, of which there are no more than two.
  ::mallopt(M_MMAP_THRESHOLD, 1 << 18);
  ::mallopt(M_ARENA_MAX, 2);
  if (const auto options = parseViewerOptions(argc, argv)) runViewer(*options);
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) { return strata::exitCodeOf(strata::run, argc, argv); }
