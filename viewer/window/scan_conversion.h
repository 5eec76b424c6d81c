#pragma once
#include <string>

namespace strata {

/// The program strata-convert, run as a process of its own on one scan. Its memory and its crashes are not ours, and
/// what it leaves when it is stopped can be resumed.
class ScanConversion {
 public:
  enum class State { running, done, failed };

  /// Starts strata-convert, which lies beside this program. Throws Error where it cannot be started.
  ScanConversion(const std::string& scan, const std::string& store);
  /// Stops the program where it still runs, and waits for it to end.
  ~ScanConversion();
  ScanConversion(const ScanConversion&) = delete;
  ScanConversion& operator=(const ScanConversion&) = delete;

  /// Reads what the program has said since the last call; never waits.
  State poll();
  /// The newest line, for people: "distribute, 41 %, 12.3 M points/s, 103 s left"; after a failure, the reason.
  const std::string& said() const { return said_; }
  /// The share of the present stage that is done, 0 to 1.
  double share() const { return share_; }

 private:
  void takeLine(const std::string& line);

  int process_ = -1;
  int pipe_ = -1;  ///< the reading end of its stderr
  std::string text_, said_;
  double share_ = 0.0;
};

}  // namespace strata
