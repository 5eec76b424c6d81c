#pragma once
#include <chrono>

namespace strata {

/// Measures wall time in laps: from construction to the first lapMs(), then from one lapMs() to the next.
class Stopwatch {
 public:
  double lapMs() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace strata
