#pragma once
#include <string>

namespace strata {

/// Asks the system to forget what it holds of a file in memory, so that the next reads come from the disk, and
/// returns the share of the file that is held nevertheless (0 to 1). Throws Error when the file cannot be opened.
double dropFromPageCache(const std::string& path);

/// The share of a file that is held in memory (0 to 1). Throws Error when the file cannot be opened.
double shareInPageCache(const std::string& path);

}  // namespace strata
