#include "converter/distribute/describe_store.h"

#include <string>

#include "core/error.h"
#include "core/version.h"

namespace strata {

void checkCounts(const Sources& sources, bool skipDamaged, Distribution& all) {
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const SourceInfo& info = sources[s]->info();
    const std::uint64_t read = all.sourcePoints[s] + all.sourceSkipped[s];
    if (read >= info.pointCount) continue;
    if (!skipDamaged)
      throw Error(info.path, "the file ends early, found " + std::to_string(read) + " points (expected " +
                                 std::to_string(info.pointCount) + "); --skip-damaged converts what is there");
    all.sourceSkipped[s] += info.pointCount - read;
  }
  if (all.points == 0) throw Error(sources.front()->info().path, "has no point with finite coordinates");
}

StoreInfo describeStore(const Conversion& conversion, const Survey& survey, const Distribution& all) {
  StoreInfo info;
  info.program = "strata " + version();
  info.points = all.points;
  info.bounds.min = survey.grid.offset + survey.grid.scale * all.bounds.min;
  info.bounds.max = survey.grid.offset + survey.grid.scale * all.bounds.max;
  info.grid = survey.grid;
  info.cubeBits = survey.cubeBits;
  info.crs = survey.crs;
  info.layout = survey.layout;
  info.ranges = all.ranges;
  info.nodePoints = conversion.options.nodePoints;
  info.sampling = "ntree";
  info.las = survey.las;
  if (const int rgb = survey.layout.find(attribute::kRgb); rgb >= 0)
    info.colourShift = all.ranges[static_cast<std::size_t>(rgb)].max > 255.0 ? 8 : 0;
  for (std::size_t s = 0; s < conversion.sources.size(); ++s) {
    const SourceInfo& source = conversion.sources[s]->info();
    info.sources.push_back({source.path, source.format, all.sourcePoints[s], all.sourceSkipped[s]});
    info.skipped += all.sourceSkipped[s];
  }
  return info;
}

}  // namespace strata
