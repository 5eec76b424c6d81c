#include "core/program/stop_signal.h"

#include <csignal>

namespace strata {
namespace {
std::atomic<bool> stopFlag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");
}  // namespace

void listenForStop() {
  struct sigaction action {};
  action.sa_handler = [](int) { stopFlag = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // without SA_RESTART: a blocked open() returns
  for (const int signal : {SIGINT, SIGTERM}) ::sigaction(signal, &action, nullptr);
}

const std::atomic<bool>& stopAsked() { return stopFlag; }

}  // namespace strata
