#pragma once
#include <cstdint>
#include <string>

namespace CLI {
class App;
}

namespace strata {

/// Parses the command line of a program. Returns false when --help or --version was asked for and has been printed.
/// Throws UsageError for options that `app` does not understand.
bool parseCommandLine(CLI::App& app, int argc, const char* const* argv);

/// The number of bytes in "2G", "512M", "64k" or "1000"; the units are powers of 1024. Throws UsageError naming
/// `option`.
std::uint64_t parseBytes(const std::string& option, const std::string& text);

}  // namespace strata
