#pragma once
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

 private:
  void takeLine(const std::string& line);

  int process_ = -1;
  int pipe_ = -1;  ///< its stderr
  std::string text_, said_;
};

/// What a progress line of strata-convert --json says, for people; the line itself where it is something else.
std::string progressText(const std::string& line);

/// Where the store of a scan belongs: beside it, with the ending .strata.
std::string storeBeside(const std::string& scan);
/// A folder with a store.json.
bool isStore(const std::string& path);

/// Stands each scan among `options.stores` for the store beside it. Where there is none the user is asked, in a window,
/// whether to convert (not asked with options.convert), and sees how far it is. False when the user would rather not.
/// Throws Error when a conversion fails.
bool convertScans(ViewerOptions& options);

}  // namespace strata
