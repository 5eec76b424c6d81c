#pragma once
#include <string>
#include <vector>

namespace strata {

/// The path of strata-convert, which lies beside this program. Throws Error when it is not there.
std::string converterProgram();

/// Runs strata-convert and waits for its end. Its output on stdout is dropped. Throws Error when it fails.
void convertToStore(const std::string& input, const std::string& store, const std::vector<std::string>& options);

}  // namespace strata
