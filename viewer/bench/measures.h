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
  double gpuMs = 0.0;               ///< of drawMs, by OpenGL's own clock; 0 for cpu
  std::uint64_t pointsDrawn = 0;    ///< sent through projection
  std::uint64_t pointsListed = 0;   ///< in the render list, before culling
  std::uint32_t nodes = 0;          ///< in the render list
  std::uint32_t missingNodes = 0;   ///< wanted, not there yet
  double detail = 1.0;              ///< share of the wanted nodes drawn as finely as wanted; see jump_watch.h
  std::uint64_t bytesRead = 0;      ///< from the store since it was opened
  std::uint64_t bytesUploaded = 0;  ///< in this frame
  std::uint64_t queueLength = 0;    ///< nodes waiting to be read
  std::uint64_t residentBytes = 0;  ///< of decoded nodes in memory
  std::uint64_t gpuBytes = 0;       ///< of nodes in GPU memory
  std::uint64_t pixelsCovered = 0;  ///< that show a point
  double widestSpacingPx = 0.0;     ///< see screen_spacing.h
  bool hitch = false;
};

/// How fast the picture fills after a jump of the camera: at the start and at each cut of the path. Each time counts
/// milliseconds from the jump to the first finished frame that draws a given share of the wanted nodes as finely as
/// wanted (at the start: to the render list of that frame). It is -1 when the next jump or the end of the path comes
/// first.
struct JumpRecord {
  static constexpr double kShares[3] = {0.80, 0.95, 1.00};

  double t = 0.0;  ///< seconds along the path
  double reachedMs[3] = {-1.0, -1.0, -1.0};
};

/// The measures of a run; `--json` prints exactly these.
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
  double hitchesPerMinute = 0.0;              ///< of the sum of the frame times
  double hitchTimeShare = 0.0;                ///< of that sum that hitches took, 0 to 1
  double pointsPerPixelWon = 0.0;             ///< points sent through projection for each pixel that shows one
  double pointsReadPerPixel = 0.0;            ///< points read from the store for each of them
  double gpuMs = 0.0;                         ///< mean of FrameRecord::gpuMs
  double spacingP50 = 0.0, spacingP95 = 0.0;  ///< of FrameRecord::widestSpacingPx
  std::uint64_t peakRssBytes = 0;             ///< of the process, since it began
  std::uint64_t gpuPeakBytes = 0;             ///< of node data
  double cpuOfOthers = 0.0;                   ///< share of the machine's CPU time that other programs took, 0 to 1
  std::string backend;
  std::string device;
};

/// A frame over this, and over kHitchRatio times the one before, is a hitch: the flight visibly stumbles.
inline constexpr double kHitchMs = 60.0;
inline constexpr double kHitchRatio = 1.5;
bool isHitch(double previousMs, double frameMs);

/// The measures that follow from the frames alone.
BenchMeasures measureFrames(std::span<const FrameRecord> frames);

/// The median of each measure over several runs of one flight.
BenchMeasures medianMeasures(std::span<const BenchMeasures> runs);
/// The spread of a measure over several runs.
struct MeasureNoise {
  std::string name;    ///< "frame_ms p50"
  double share = 0.0;  ///< (largest - smallest) / median over the runs
};
/// Nothing for fewer than two runs.
std::vector<MeasureNoise> measureNoise(std::span<const BenchMeasures> runs);

/// One measure in which runs are compared: its name in text, and its place in the JSON.
struct MeasureField {
  enum class Better { lower, higher, neither };

  const char* name;     ///< "frame_ms p50"
  const char* pointer;  ///< JSON pointer, "/frame_ms/p50"
  Better better;
  bool whole;  ///< a count
  double (*get)(const BenchMeasures&);
  void (*set)(BenchMeasures&, double);
};
std::span<const MeasureField> measureFields();

/// One line of JSON.
std::string measuresJson(const BenchMeasures& measures);

}  // namespace strata
