#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "io/scan/point_source.h"

namespace strata {

/// The colour that the points of nodes with children are drawn in.
enum class LodColour : std::uint8_t {
  first,   ///< their own
  average  ///< the mean of the points that they represent
};

inline constexpr std::uint64_t kLeastMemoryBytes = std::uint64_t{512} << 20;
inline constexpr std::uint32_t kLeastNodePoints = 1024;
inline constexpr std::uint32_t kMostNodePoints = 1u << 20;

/// How a conversion is asked for; the command line of strata-convert sets one member per option.
struct ConvertOptions {
  std::vector<std::string> inputs;
  std::string output;      ///< NAME.strata
  std::string tempFolder;  ///< the folder of the spill; empty = that of the store being built
  std::uint64_t memoryBytes = std::uint64_t{2} << 30;  ///< at least kLeastMemoryBytes
  int threads = 0;                                     ///< 0 = all cores
  std::uint32_t nodePoints = 65536;                    ///< from kLeastNodePoints to kMostNodePoints
  LodColour lodColour = LodColour::first;
  bool force = false;    ///< replace an existing store, start an interrupted conversion again
  bool resume = false;   ///< go on with an interrupted conversion, if there is one
  bool normals = false;  ///< estimate normals where the scans have none
  SourceOptions source;
};

/// The number of threads that the options ask for, at least 1.
inline int threadsOf(const ConvertOptions& options) {
  return options.threads > 0 ? options.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace strata
