#include "viewer/session/command_line.h"

#include <CLI/CLI.hpp>
#include <iostream>

#include "core/error.h"

namespace strata {

bool parseCommandLine(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    app.exit(asked, std::cout, std::cerr);
    return false;
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  return true;
}

}  // namespace strata
