#pragma once
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "converter/options.h"

namespace strata {

/// How a conversion stands at one moment.
struct ProgressMoment {
  std::string stage;                  ///< of namespace stage
  std::uint64_t done = 0, total = 0;  ///< points of the stage; total 0 = not known
  double pointsPerSecond = 0.0;       ///< in this stage so far; 0 = not known
  std::uint64_t memoryBytes = 0;      ///< resident now
  double elapsedSeconds = 0.0;        ///< since the start of the program
  std::optional<double> secondsLeft;  ///< until the store is complete
};

/// Seconds until the store is complete: what is left of the running stage at the rate it has had, and for each stage
/// to come what it usually takes (kTypicalMicros in the .cpp, CPU time a point) shared by the threads. Nothing while
/// the number of points is unknown, or where a stage that cannot say how far it is takes longer than usual.
/// `stageSeconds` is how long the stage has run.
std::optional<double> secondsLeft(const Progress& progress, double stageSeconds, std::uint64_t points, int threads);

/// "distribute  41 %  206.0/500.0 M points  12.3 M/s  512 MiB  1 min 43 s left": at most 80 columns below 1e12
/// points.
std::string progressLine(const ProgressMoment& moment);
/// The same as a JSON object with "progress": the stage.
std::string progressJson(const ProgressMoment& moment);
/// "43 s", "12 min 30 s", "2 h 10 min".
std::string durationText(double seconds);

/// Shows how far a conversion is, from a thread of its own: on a terminal one line that is rewritten four times a
/// second, else a line (or a JSON object) every ten seconds, so that short runs say nothing.
class ProgressDisplay {
 public:
  enum class Style { terminal, lines, json };

  /// `threads` are those of the conversion. `out` outlives this.
  ProgressDisplay(Style style, std::FILE* out, int threads,
                  std::chrono::milliseconds interval = std::chrono::seconds(10));
  /// Takes the terminal's line away.
  ~ProgressDisplay();
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  /// Any thread; costs a lock.
  void update(const Progress& progress);

 private:
  using Clock = std::chrono::steady_clock;

  void run(const std::stop_token& stop);
  void print(const ProgressMoment& moment);
  ProgressMoment moment() const;  ///< under mutex_; without the memory

  const Style style_;
  std::FILE* const out_;
  const int threads_;
  const std::chrono::milliseconds interval_;
  const Clock::time_point begin_ = Clock::now();

  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  Progress latest_;  ///< guarded by mutex_, as the three below
  Clock::time_point stageBegin_ = begin_;
  std::uint64_t stageFirst_ = 0;  ///< points that the stage had done when it began (a resumed conversion)
  std::uint64_t points_ = 0;      ///< of the whole conversion, as far as known

  bool shown_ = false;  ///< used by the display's thread, and by the destructor after it
  std::jthread thread_;
};

}  // namespace strata
