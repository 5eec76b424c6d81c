#pragma once
#include <string>

namespace strata {

/// Lines on stderr for the person at the terminal. Thread-safe.
void logInfo(const std::string& message);
void logWarning(const std::string& message);

/// Keeps info lines back (warnings still appear).
void setQuiet(bool quiet);

}  // namespace strata
