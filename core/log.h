#pragma once
#include <string>

namespace strata {

/// Write a line to stderr for the person at the terminal. Thread-safe.
void logInfo(const std::string& message);
void logWarning(const std::string& message);

/// Keeps info lines back; warnings still appear.
void setQuiet(bool quiet);

}  // namespace strata
