#include <cstdio>
#include <exception>

#include "core/error.h"
#include "viewer/viewer_app.h"

int main(int argc, char** argv) {
  try {
    const auto options = strata::parseViewerOptions(argc, argv);
    if (options) strata::runViewer(*options);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return dynamic_cast<const strata::UsageError*>(&error) != nullptr ? 2 : 1;
  }
}
