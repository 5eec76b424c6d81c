#pragma once
#include <chrono>
#include <string>
#include <vector>

#include "converter/control.h"

namespace strata {

/// The time that a stage took.
struct StageTime {
  std::string name;  ///< one of namespace stage
  double seconds = 0.0, cpuSeconds = 0.0;
};

/// The CPU time of the process so far, over all threads, in seconds.
double cpuSeconds();

/// Times one stage after the other and reports the beginning of each. Used by one thread.
class StageClock {
 public:
  /// Finished stages are appended to `times`. Both arguments must outlive the clock.
  StageClock(std::vector<StageTime>& times, const ConvertControl& control) : times_(times), control_(control) {}
  /// Ends the running stage, if there is one, and begins `stage`.
  void begin(const char* stage);
  void end();

 private:
  std::vector<StageTime>& times_;
  const ConvertControl& control_;
  const char* stage_ = nullptr;
  std::chrono::steady_clock::time_point begin_;
  double cpuBegin_ = 0.0;
};

}  // namespace strata
