#pragma once
#include <optional>
#include <string>

#include "viewer/window/viewer_app.h"

namespace strata {

/// The program strata-convert, run beside us on one scan.
class ScanConversion {
 public:
  /// Starts it; it lies beside this program. Throws Error when it does not.
  ScanConversion(const std::string& scan, const std::string& store);
  /// Ends it where it still runs; what it leaves can be resumed.
  ~ScanConversion();
  ScanConversion(const ScanConversion&) = delete;
  ScanConversion& operator=(const ScanConversion&) = delete;

  enum class State { running, done, failed };
  /// Reads what it has said since; never waits.
  State poll();
  /// "distribute, 41 %, 12.3 M points/s, 1 min 43 s left", or the one line that says why it failed.
  const std::string& said() const { return said_; }
  /// Of the present step, 0 to 1.
  double share() const { return share_; }

 private:
  void takeLine(const std::string& line);

  int process_ = -1;
  int pipe_ = -1;  ///< its stderr
  std::string text_, said_;
  double share_ = 0.0;
};

/// What a progress line of strata-convert --json says, for people; the line itself where it is something else.
std::string progressText(const std::string& line);

/// How much of the step that is done, where the line says it.
std::optional<double> progressShare(const std::string& line);

/// Where the store of a scan belongs: beside it, with the ending .strata.
std::string storeBeside(const std::string& scan);
/// A folder with a store.json.
bool isStore(const std::string& path);

/// Stands each scan among `options.stores` for the store beside it. Where there is none the user is asked, in a window,
/// whether to convert and where to, sees how far it is and why it failed. With options.convert nobody is asked, and a
/// conversion that fails throws Error. False when the user would rather not.
bool convertScans(ViewerOptions& options);

}  // namespace strata
