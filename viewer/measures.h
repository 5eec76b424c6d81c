#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace strata {

/// One played frame. Times in milliseconds, measured on the render thread unless the name says otherwise.
struct FrameRecord {
  int index = 0;
  double t = 0.0;        ///< seconds along the path
  double frameMs = 0.0;  ///< from taking the render list to the finished picture
  double listMs = 0.0;   ///< taking the render list
  double uploadMs = 0.0;
  double drawMs = 0.0;
  double resolveMs = 0.0;
  double settleMs = 0.0;            ///< waited for full detail before the frame (--settle), not in frameMs
  double lodMs = 0.0;               ///< newest LOD pass, on its own thread
  std::uint64_t pointsDrawn = 0;    ///< sent through projection
  std::uint64_t pointsListed = 0;   ///< in the render list, before culling
  std::uint32_t nodes = 0;          ///< in the render list
  std::uint32_t missingNodes = 0;   ///< wanted, not there yet
  std::uint64_t bytesRead = 0;      ///< from the store since it was opened
  std::uint64_t bytesUploaded = 0;  ///< in this frame
  bool hitch = false;
};

/// The figures of a run; `--json` prints exactly these.
struct BenchMeasures {
  int frames = 0;
  double p50Ms = 0.0, p95Ms = 0.0, p99Ms = 0.0, maxMs = 0.0;  ///< of FrameRecord::frameMs
  double pointsPerSecond = 0.0;                               ///< points drawn over the sum of the frame times
  double pointsDrawnMean = 0.0;
  double timeToFullDetailMs = 0.0;  ///< from an empty cache to the first view complete
  double lodMs = 0.0;               ///< mean of a LOD pass
  std::uint64_t bytesRead = 0;
  double cacheHitRate = 0.0;  ///< 0 to 1
  int hitches = 0;
  std::string backend;
  std::string device;
};

/// A frame over this, and over kHitchRatio times the one before, is a hitch: the flight visibly stumbles.
inline constexpr double kHitchMs = 60.0;
inline constexpr double kHitchRatio = 1.5;
bool isHitch(double previousMs, double frameMs);

/// The p-th percentile, 0 to 100, linear between ranks (Hyndman and Fan 1996, type 7). 0 for no values.
double percentile(std::span<const double> values, double p);

/// The part of the measures that follows from the frames alone.
BenchMeasures measureFrames(std::span<const FrameRecord> frames);

/// One line of JSON.
std::string measuresJson(const BenchMeasures& measures);

/// One measure of two runs. `ratio` is b / a.
struct MeasureChange {
  std::string name;
  double a = 0.0, b = 0.0;
  double ratio = 1.0;
  double worseBy = 0.0;  ///< share by which b is worse than a, 0.05 = 5 %; negative = better; 0 where neither is better
};

/// Compares two report.json texts. Throws Error naming `fileA` or `fileB` when one is no report.
struct Comparison {
  std::vector<MeasureChange> changes;
  std::vector<std::string> differences;  ///< "backend: cpu / points": what makes the runs unlike
};
Comparison compareReports(const std::string& fileA, const std::string& jsonA, const std::string& fileB,
                          const std::string& jsonB);
std::string comparisonTable(const Comparison& comparison, double failAbove);
/// `failAbove` as a share. Infinite = nothing fails.
bool anyWorse(const Comparison& comparison, double failAbove);

}  // namespace strata
