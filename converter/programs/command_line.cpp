#include "converter/programs/command_line.h"

#include <CLI/CLI.hpp>

#include "core/error.h"
#include "core/version.h"

namespace strata {

bool parseCommandLine(CLI::App& app, int argc, char** argv) {
  app.set_version_flag("--version", version());
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    app.exit(asked);
    return false;
  } catch (const CLI::ParseError& problem) {
    throw UsageError(problem.what());
  }
  return true;
}

}  // namespace strata
