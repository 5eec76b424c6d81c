#include "core/program/exit_code.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "core/error.h"

namespace strata {
namespace {

int reportFailure(const std::exception& failure) {
  std::string line = failure.what();
  if (dynamic_cast<const std::bad_alloc*>(&failure) != nullptr) line = "memory: there is not enough of it";
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::fflush(stdout);
  std::fprintf(stderr, "error: %s\n", line.c_str());
  return dynamic_cast<const UsageError*>(&failure) != nullptr ? 2 : 1;
}

}  // namespace

int exitCodeOf(int (*program)(int argc, char** argv), int argc, char** argv) {
  try {
    return program(argc, argv);
  } catch (const std::exception& failure) {
    return reportFailure(failure);
  }
}

void flushOutput() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw posixError("stdout", "writing", errno);
}

}  // namespace strata
