#pragma once

namespace CLI {
class App;
}

namespace strata {

/// Adds --version and parses. False when all is said already (--help, --version); throws UsageError for what cannot be
/// understood.
bool parseCommandLine(CLI::App& app, int argc, char** argv);

}  // namespace strata
