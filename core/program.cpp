#include "core/program.h"

#include <csignal>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <new>

#include "core/error.h"

namespace strata {
namespace {
std::atomic<bool> stopFlag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");
}  // namespace

int reportFailure(const std::exception& failure) {
  std::string line = failure.what();
  if (dynamic_cast<const std::bad_alloc*>(&failure) != nullptr) line = "memory: there is not enough of it";
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::fflush(stdout);
  std::fprintf(stderr, "error: %s\n", line.c_str());
  return dynamic_cast<const UsageError*>(&failure) != nullptr ? 2 : 1;
}

void flushOutput() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw posixError("stdout", "writing", errno);
}

void listenForStop() {
  struct sigaction action {};
  action.sa_handler = [](int) { stopFlag = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // without SA_RESTART: a blocked open() returns
  for (const int signal : {SIGINT, SIGTERM}) ::sigaction(signal, &action, nullptr);
}

const std::atomic<bool>& stopAsked() { return stopFlag; }

std::uint64_t parseBytes(const std::string& option, const std::string& text) {
  double value = 0.0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string unit(end, text.data() + text.size());
  for (char& c : unit) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  if (unit.size() > 1 && unit.back() == 'B') unit.pop_back();
  if (unit.size() > 1 && unit.back() == 'I') unit.pop_back();
  const std::string units = "KMGT";
  const std::size_t power = unit.empty() || unit == "B" ? 0 : unit.size() == 1 ? units.find(unit[0]) + 1 : 0;
  const bool known = unit.empty() || unit == "B" || power > 0;
  const double bytes = std::ldexp(value, static_cast<int>(power) * 10);
  if (failure != std::errc() || !known || !(bytes >= 0.0) || bytes > 9e18)
    throw UsageError(option, "found '" + text + "' (expected a size such as 512M or 2G)");
  return static_cast<std::uint64_t>(bytes);
}

std::string grouped(std::uint64_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, 1, ' ');
  return digits;
}

}  // namespace strata
