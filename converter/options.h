#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/log.h"
#include "io/scan/point_source.h"
#include "io/store/plane_sizes.h"

namespace strata {

/// How a node's points are picked and ordered. All but `ntree` are there to be measured against it.
enum class Sampling : std::uint8_t {
  ntree,    ///< levelOrder()
  poisson,  ///< no two points of a prefix closer than a distance that shrinks from level to level, by random trial
  random    ///< any
};
const char* samplingName(Sampling sampling);

/// Which colour the points of nodes with children are drawn in.
enum class LodColour : std::uint8_t {
  first,   ///< their own
  average  ///< the mean of the points that they stand for
};

struct ConvertOptions {
  std::vector<std::string> inputs;
  std::string output;      ///< NAME.strata
  std::string tempFolder;  ///< for spilled points; empty = beside the output
  std::uint64_t memoryBytes = std::uint64_t{2} << 30;
  int threads = 0;  ///< 0 = all cores
  std::uint32_t nodePoints = 65536;
  Sampling sampling = Sampling::ntree;
  LodColour lodColour = LodColour::first;
  bool force = false;    ///< replace an existing store, start an interrupted conversion again
  bool resume = false;   ///< go on with an interrupted conversion, if there is one
  bool normals = false;  ///< estimate them where the scans have none
  SourceOptions source;
};

/// CPU time of the process so far, all threads.
double cpuSeconds();

/// How many threads the options ask for: 0 means all cores.
int threadsOf(const ConvertOptions& options);

inline constexpr std::uint64_t kLeastMemoryBytes = std::uint64_t{512} << 20;
inline constexpr std::uint32_t kLeastNodePoints = 1024;
inline constexpr std::uint32_t kMostNodePoints = 1u << 20;

/// The stages of a conversion in their order (docs/architecture.md): what Progress and ConvertReport call them.
/// "measure" is there only for scans whose headers do not say where the points are.
namespace stage {
inline constexpr const char* kSurvey = "survey";
inline constexpr const char* kMeasure = "measure";
inline constexpr const char* kDistribute = "distribute";
inline constexpr const char* kBuild = "build";
inline constexpr const char* kMerge = "merge";
inline constexpr const char* kNormals = "normals";  // where they are asked for
inline constexpr const char* kWrite = "write";
}  // namespace stage

/// How far a stage is; called from any thread, some hundred times a second at most.
struct Progress {
  const char* stage = "";             ///< of namespace stage
  std::uint64_t done = 0, total = 0;  ///< points; both 0 where a stage cannot say
};

/// What a conversion reports (design section 10).
struct ConvertReport {
  std::uint64_t points = 0, nodes = 0, skipped = 0;
  std::uint64_t inputBytes = 0, outputBytes = 0, tempPeakBytes = 0;
  struct Stage {
    std::string name;  ///< of namespace stage
    double seconds = 0.0, cpuSeconds = 0.0;
  };
  std::vector<Stage> stages;
  std::vector<std::uint64_t> nodesByLevel, pointsByLevel;  ///< from the root down
  std::vector<PlaneSize> planes;
};

/// What the stages share besides the options: progress and the wish to stop.
struct ConvertControl {
  std::function<void(const Progress&)> progress = [](const Progress&) {};
  std::function<void(const std::string&)> warn = [](const std::string& message) { logWarning(message); };
  const std::atomic<bool>* stop = nullptr;  ///< set from a signal handler
  /// Throws Stopped when the user asked to.
  void checkStop() const;
};

/// Converts the inputs to a store. Nothing carries the final name before it is complete and durable. Whatever was begun
/// is removed when an Error is thrown, but stays for options.resume when that is Stopped or when the store is finished
/// and only its name is taken. Same inputs and options give the same bytes for any number of threads.
ConvertReport convert(const ConvertOptions& options, const ConvertControl& control);
/// The same for scans that are open already; options.inputs is not looked at.
ConvertReport convert(const std::vector<std::unique_ptr<PointSource>>& sources, const ConvertOptions& options,
                      const ConvertControl& control);

}  // namespace strata
