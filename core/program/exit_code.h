#pragma once

namespace strata {

/// Runs a program and returns its exit code. An exception becomes one line on stderr, `error: WHAT`, and the exit code
/// 2 for a UsageError or 1 for anything else.
int exitCodeOf(int (*program)(int argc, char** argv), int argc, char** argv);

/// Throws Error when what was printed did not reach its reader, for example because the disk behind stdout is full.
void flushOutput();

}  // namespace strata
