#pragma once

namespace CLI {
class App;
}

namespace strata {

/// False when all is said already (--help, --version); throws UsageError for what cannot be understood.
bool parseCommandLine(CLI::App& app, int argc, const char* const* argv);

}  // namespace strata
