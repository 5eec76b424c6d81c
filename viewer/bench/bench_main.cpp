#include <iostream>

#include "core/error.h"
#include "core/program/exit_code.h"
#include "core/readable.h"
#include "io/file/text_file.h"
#include "viewer/bench/bench_options.h"
#include "viewer/bench/bench_run.h"
#include "viewer/bench/compare.h"
#include "viewer/camera/path_maker.h"

namespace strata {
namespace {

int compare(const BenchOptions& options) {
  const Comparison comparison = compareRuns(options.reportA, options.reportB);
  std::cout << comparisonTable(comparison, options.failAbove);
  if (!options.comparison.empty())
    writeText(options.comparison, comparisonHtml(options.reportA, options.reportB, comparison, options.failAbove));
  return anyWorse(comparison, options.failAbove) ? 1 : 0;
}

void printSummary(const BenchOptions& options, const BenchReport& report) {
  const BenchMeasures& m = report.measures;
  if (m.frames > 0)
    std::cout << m.frames << " frames, " << readableMs(m.p50Ms) << " median, " << readableMs(m.p99Ms)
              << " 99th percentile, " << readableCount(m.pointsPerSecond) << " points/s, " << m.hitches << " hitches ("
              << m.backend << ", " << m.device << ")\n";
  std::cout << options.output << "/report.html\n";
}

int run(int argc, char** argv) {
  const std::optional<BenchOptions> options = parseBenchOptions(argc, argv);
  if (!options) return 0;
  if (options->command == BenchOptions::Command::compare) return compare(*options);
  if (options->command == BenchOptions::Command::makePath) {
    const Store store(options->store);
    std::cout << cameraPathJson(makePath(options->makePath, sampleStore(store), store));
  } else {
    const BenchReport report = runBench(*options);
    if (options->json)
      std::cout << measuresJson(report.measures) << "\n";
    else
      printSummary(*options, report);
  }
  std::cout.flush();
  if (!std::cout) throw Error("stdout", "cannot be written");
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) { return strata::exitCodeOf(strata::run, argc, argv); }
