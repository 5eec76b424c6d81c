#include "viewer/bench/bench_run.h"

#include <ctime>

#include "core/version.h"
#include "io/file/text_file.h"
#include "viewer/bench/flight.h"
#include "viewer/bench/page_cache.h"
#include "viewer/bench/report_facts.h"
#include "viewer/bench/take_stills.h"
#include "viewer/session/draw_defaults.h"
#include "viewer/session/program_rasterizer.h"

namespace strata {
namespace {

std::string utcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}  // namespace

BenchReport runBench(const BenchOptions& options) {
  const auto store = std::make_shared<const Store>(options.store);
  const std::unique_ptr<Rasterizer> rasterizer = createWindowlessRasterizer(
      options.backend,
      progressiveOptions(options.progressive, options.streamer.selection.pointBudget, store->info().points));
  makeFolder(options.output);

  const std::string pageCache = options.cold ? dropPages(*store) : pagesAsTheyAre(*store);
  DrawOptions draw = drawOptionsFor(store->info(), store->info().bounds, options.colour);
  applyDrawFlags(options.draw, draw);
  draw.pointSize = options.pointSize;
  draw.edl = options.edl;

  BenchReport report;
  report.program = "strata-bench " + version();
  report.commit = commit();
  report.when = utcNow();
  report.storePath = options.store;
  report.storeName = storeName(options.store);
  report.storeHash = storeHash(*store);
  report.store = storeFacts(*store);
  report.options = optionFacts(options, draw, pageCache);
  report.machine = thisMachine();
  report.measures.backend = rasterizer->name();
  report.measures.device = rasterizer->device();
  if (!options.path.empty()) flyPath(options, store, *rasterizer, draw, report);
  if (options.stills) takeStills(options, store, *rasterizer, report);
  writeReport(options.output, report);
  return report;
}

}  // namespace strata
