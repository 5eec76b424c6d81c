#include <exception>

#include "core/program.h"
#include "viewer/window/viewer_app.h"

int main(int argc, char** argv) {
  try {
    const auto options = strata::parseViewerOptions(argc, argv);
    if (options) strata::runViewer(*options);
    return 0;
  } catch (const std::exception& error) {
    return strata::reportFailure(error);
  }
}
