#pragma once
#include <stdexcept>
#include <string>

namespace strata {

/// The one exception type. Construction and I/O throw it; selection, cache, queue and draw never throw. what() is the
/// whole line that a user reads after "error: ", in the form `FILE: what is wrong, found X (expected Y)`.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
  Error(const std::string& file, const std::string& message) : std::runtime_error(file + ": " + message) {}
};

/// Wrong usage of a program (exit code 2): an option's value that cannot be understood.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// Makes `FILE: opening: No such file or directory` out of errno. This is the only place where errno becomes text.
Error posixError(const std::string& file, const std::string& doing, int errnoValue);

}  // namespace strata
