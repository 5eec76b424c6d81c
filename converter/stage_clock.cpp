#include "converter/stage_clock.h"

#include <ctime>

namespace strata {

double cpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void StageClock::begin(const char* stage) {
  end();
  stage_ = stage;
  control_.progress({stage, 0, 0});
}

void StageClock::end() {
  const auto now = std::chrono::steady_clock::now();
  const double cpu = cpuSeconds();
  if (stage_ != nullptr)
    times_.push_back({stage_, std::chrono::duration<double>(now - begin_).count(), cpu - cpuBegin_});
  stage_ = nullptr;
  begin_ = now;
  cpuBegin_ = cpu;
}

}  // namespace strata
