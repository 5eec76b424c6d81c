#include "converter/distribute/run_plan.h"

#include <algorithm>
#include <cstdint>

#include "converter/distribute/run_sorter.h"

namespace strata {
namespace {

constexpr std::size_t kLeastRun = 65536, kMostRun = 1 << 20;    // points
constexpr std::uint64_t kReaderBytes = std::uint64_t{4} << 20;  // blocks and decoder of a thread, besides its run

}  // namespace

RunPlan planRuns(const PackedFormat& format, const ConvertOptions& options) {
  const std::uint64_t budget = options.memoryBytes / 4;
  const std::uint64_t share = budget / static_cast<std::uint64_t>(options.threads);
  const std::uint64_t perPoint = RunSorter::memoryBytes(format, kLeastRun) / kLeastRun + 1;
  RunPlan plan;
  plan.runPoints =
      std::clamp<std::size_t>(share > kReaderBytes ? (share - kReaderBytes) / perPoint : 0, kLeastRun, kMostRun);
  // Runs have a least size, so that with little memory fewer threads collect one.
  const std::uint64_t worker = RunSorter::memoryBytes(format, plan.runPoints) + kReaderBytes;
  plan.workers =
      static_cast<int>(std::clamp<std::uint64_t>(budget / worker, 1, static_cast<std::uint64_t>(options.threads)));
  return plan;
}

}  // namespace strata
