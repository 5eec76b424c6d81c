#pragma once
#include <atomic>
#include <cstdint>
#include <exception>
#include <string>

namespace strata {

/// What every main does with an exception: prints `error: WHAT` as one line on stderr and returns the exit code,
/// 2 for UsageError, else 1.
int reportFailure(const std::exception& failure);

/// Throws Error when what was printed did not reach its reader (a full disk behind stdout).
void flushOutput();

/// Sets the flag that stopAsked() returns on SIGINT and SIGTERM. A second signal ends the program at once.
void listenForStop();
const std::atomic<bool>& stopAsked();

/// "2G", "512M", "64k", "1000": bytes, with binary multiples. Throws UsageError naming `option`.
std::uint64_t parseBytes(const std::string& option, const std::string& text);

/// "1 234 567": a count for people.
std::string grouped(std::uint64_t count);

}  // namespace strata
