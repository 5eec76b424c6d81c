#pragma once
#include <string>
#include <vector>

namespace strata {

/// Where strata-convert lies: beside this program. Throws Error where it does not.
std::string converterProgram();

/// Runs it and waits for it; what it says on stdout is dropped. Throws Error where it fails.
void convertToStore(const std::string& input, const std::string& store, const std::vector<std::string>& options);

}  // namespace strata
