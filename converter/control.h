#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "core/log.h"
#include "io/scan/point_source.h"

namespace strata {

/// The stages of a conversion in their order: Progress and ConvertReport call them by these names. "measure" runs only
/// for scans whose headers do not say where their points lie, "normals" only where normals are asked for.
namespace stage {
inline constexpr const char* kSurvey = "survey";
inline constexpr const char* kMeasure = "measure";
inline constexpr const char* kDistribute = "distribute";
inline constexpr const char* kBuild = "build";
inline constexpr const char* kMerge = "merge";
inline constexpr const char* kNormals = "normals";
inline constexpr const char* kWrite = "write";
}  // namespace stage

/// How far a stage has come.
struct Progress {
  const char* stage = "";             ///< one of namespace stage
  std::uint64_t done = 0, total = 0;  ///< points; both 0 where a stage cannot say
};

/// How a conversion talks to its caller. `progress` is called from any thread, some hundred times a second at most.
struct ConvertControl {
  std::function<void(const Progress&)> progress = [](const Progress&) {};
  std::function<void(const std::string&)> warn = [](const std::string& message) { logWarning(message); };
  const std::atomic<bool>* stop = nullptr;  ///< set to true, from a signal handler perhaps, to stop the conversion

  /// Throws Stopped when the user asked to stop.
  void checkStop() const {
    if (stop != nullptr && stop->load(std::memory_order_relaxed)) throw Stopped();
  }
};

}  // namespace strata
