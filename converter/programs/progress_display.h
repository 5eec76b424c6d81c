#pragma once
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <thread>

#include "converter/control.h"
#include "core/mutex.h"

namespace strata {

/// How far a conversion is at one moment.
struct ProgressMoment {
  std::string stage;                  ///< one of namespace stage
  std::uint64_t done = 0, total = 0;  ///< points of the stage; total 0 = not known
  double pointsPerSecond = 0.0;       ///< in this stage so far; 0 = not known
  std::uint64_t memoryBytes = 0;      ///< resident now
  double elapsedSeconds = 0.0;        ///< since the start of the program
  std::optional<double> secondsLeft;  ///< until the store is complete
};

/// Estimates the seconds until the store is complete: the rest of the running stage at the rate it has had, and for
/// each stage to come its usual CPU time per point (kTypicalMicros in the .cpp), shared by the threads. Returns nothing
/// while the number of points is unknown, or when a stage that cannot say how far it is takes longer than usual. The
/// stage has run for `stageSeconds`.
std::optional<double> secondsLeft(const Progress& progress, double stageSeconds, std::uint64_t points, int threads);

/// "distribute  41 %  206.0/500.0 M points  12.3 M/s  512 MiB  1 min 43 s left": at most 80 columns below 1e12
/// points.
std::string progressLine(const ProgressMoment& moment);
/// The same as a JSON object whose "progress" is the stage.
std::string progressJson(const ProgressMoment& moment);
/// "43 s", "12 min 30 s", "2 h 10 min".
std::string durationText(double seconds);

/// Shows how far a conversion is, from a thread of its own: on a terminal as one line that is rewritten four times a
/// second, otherwise as a line or a JSON object at every `interval`, so that short runs say nothing.
class ProgressDisplay {
 public:
  enum class Style { terminal, lines, json };

  /// `threads` are those of the conversion. `out` outlives this.
  ProgressDisplay(Style style, std::FILE* out, int threads,
                  std::chrono::milliseconds interval = std::chrono::seconds(10));
  /// Removes the line from the terminal.
  ~ProgressDisplay();
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  /// Takes a lock. Any thread.
  void update(const Progress& progress) STRATA_EXCLUDES(mutex_);

 private:
  using Clock = std::chrono::steady_clock;

  void run(const std::stop_token& stop) STRATA_EXCLUDES(mutex_);
  void print(const ProgressMoment& moment);
  /// Returns the moment with all fields set except the memory.
  ProgressMoment moment() const STRATA_REQUIRES(mutex_);

  const Style style_;
  std::FILE* const out_;
  const int threads_;
  const std::chrono::milliseconds interval_;
  const Clock::time_point begin_ = Clock::now();

  mutable Mutex mutex_;
  Condition wake_;
  Progress latest_ STRATA_GUARDED_BY(mutex_);
  Clock::time_point stageBegin_ STRATA_GUARDED_BY(mutex_) = begin_;
  std::uint64_t stageFirst_ STRATA_GUARDED_BY(mutex_) = 0;  ///< points done when the stage began (a resumed conversion)
  std::uint64_t points_ STRATA_GUARDED_BY(mutex_) = 0;      ///< of the whole conversion, as far as known

  bool shown_ = false;  ///< used by the display's thread, and by the destructor after it
  std::jthread thread_;
};

}  // namespace strata
