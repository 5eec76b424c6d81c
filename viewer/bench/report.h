#pragma once
#include <string>
#include <utility>
#include <vector>

#include "core/image.h"
#include "io/store/store.h"
#include "viewer/bench/machine.h"
#include "viewer/bench/measures.h"

namespace strata {

/// How long one stage of the frames took, over all frames of a flight.
struct FrameStage {
  std::string name;
  double meanMs = 0.0, p95Ms = 0.0;
  bool onRenderThread = true;  ///< false: it runs beside the frames and is no part of their time
};

struct ReportPicture {
  std::string title;         ///< "overview", "frame 30"
  std::string file;          ///< beside the report
  bool ofTheFlight = false;  ///< false: a still
  Image image;               ///< has no pixels when the report does not show it
  std::string hash = {};     ///< imageHash() of the picture in its full size
};

/// All results of a run, in words and numbers.
struct BenchReport {
  std::string program;  ///< "strata-bench 0.1.0"
  std::string commit;   ///< of the source it was built from; "unknown" outside of a checkout
  std::string when;     ///< ISO 8601, UTC
  std::string storePath;
  std::string storeName;                                     ///< for the headline
  std::string storeHash;                                     ///< XXH3-64 of hierarchy.bin's records, 16 digits
  std::vector<std::pair<std::string, std::string>> store;    ///< facts about the store, to be read
  std::vector<std::pair<std::string, std::string>> options;  ///< of this run
  Machine machine;
  BenchMeasures measures;  ///< frames = 0: no path was played, the report shows pictures only
  std::vector<FrameStage> stages;
  std::vector<std::pair<std::string, double>> counters;  ///< of the streamer, by name
  std::vector<FrameRecord> frames;                       ///< of the run whose median frame time is the median one
  std::vector<JumpRecord> jumps;                         ///< medians over the runs
  std::vector<BenchMeasures> runs;                       ///< of each repetition, in order
  std::vector<ReportPicture> pictures;
};

/// The XXH3-64 of a text in 16 hexadecimal digits.
std::string textHash(const std::string& text);
/// The XXH3-64 of size and pixels in 16 hexadecimal digits. Equal pictures have equal hashes.
std::string imageHash(const Image& image);
/// The hash of the hierarchy, which holds a checksum of every payload. Equal stores have equal hashes.
std::string storeHash(const Store& store);

std::string reportJson(const BenchReport& report);
std::string framesCsv(const std::vector<FrameRecord>& frames);
/// One page that needs neither other files nor the network: pictures and plots are inside.
std::string reportHtml(const BenchReport& report);

/// Writes report.json, frames.csv and report.html into `folder`. Throws Error when one cannot be written whole.
void writeReport(const std::string& folder, const BenchReport& report);

}  // namespace strata
