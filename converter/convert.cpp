#include "converter/convert.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include "converter/build/build_chunks.h"
#include "converter/build/chunk_limit.h"
#include "converter/build/merge.h"
#include "converter/build/node_sink.h"
#include "converter/distribute/describe_store.h"
#include "converter/distribute/distribute.h"
#include "converter/distribute/point_packer.h"
#include "converter/journal/conversion.h"
#include "converter/journal/disk_room.h"
#include "converter/journal/records.h"
#include "converter/journal/session.h"
#include "converter/normals/add_normals.h"
#include "converter/stage_clock.h"
#include "converter/survey/survey.h"
#include "core/error.h"
#include "io/open_scans.h"
#include "io/store/store.h"
#include "io/store/store_files.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

/// Points in the spill, and what had to be decided before they were read.
struct SpilledScan {
  Survey survey;
  Distribution all;
  PackedFormat format;
  std::uint64_t chunkLimit = 0;
};

/// True when the points show that a header lied: they lie outside the cube, or in so small a part of it that the grid
/// wastes levels.
bool boundsWereWrong(const SpilledScan& scan) {
  if (scan.all.outsideCube) return true;
  const glm::dvec3 size = scan.all.bounds.size();
  const double extent = glm::max(size.x, glm::max(size.y, size.z));
  return scan.all.points > 0 && extent + 1.0 <= std::ldexp(1.0, scan.survey.cubeBits - 2);
}

/// Surveys and distributes. Where the points show that headers cannot be believed, it reads them all for their extent
/// and starts again.
SpilledScan readInputs(const Conversion& conversion, Session& session, StageClock& clock) {
  const Sources& sources = conversion.sources;
  const int threads = conversion.options.threads;
  std::optional<MeasuredExtents> measured = readMeasured(conversion.journal);
  if (!measured) {
    if (std::any_of(sources.begin(), sources.end(), [](const auto& source) {
          return source->info().pointCount > 0 && !headerBoundsUsable(source->info());
        }))
      clock.begin(stage::kMeasure);
    measured = measureExtents(sources, false, threads, conversion.control);
    appendMeasured(conversion.journal, *measured);
  }
  clock.begin(stage::kDistribute);
  for (;;) {
    SpilledScan scan;
    scan.survey = survey(sources, *measured);
    scan.format = packedFormat(scan.survey);
    scan.chunkLimit = chunkPointLimit(conversion.options, scan.format, scan.survey.claimedPoints);
    scan.all = distribute(conversion, scan.survey, scan.chunkLimit);
    if (measured->all || !boundsWereWrong(scan)) return scan;
    scan = {};
    session.startAgain();
    measured = measureExtents(sources, true, threads, conversion.control);
    appendMeasured(conversion.journal, *measured);
  }
}

/// The scanner's place, world, where all points are one station's: several scans have several, and their points do not
/// say whose they are.
std::optional<glm::dvec3> stationOf(const Sources& sources) {
  return sources.size() == 1 ? sources.front()->info().viewpoint : std::nullopt;
}

/// Rewrites points.bin with normals and returns the most temporary bytes held meanwhile.
std::uint64_t writeNormals(const Conversion& conversion, const BuildFolder& folder, StoreInfo& info,
                           Hierarchy& hierarchy) {
  const std::string pointsPath = folder.path() + "/" + kPointsFile, newPath = folder.path() + "/" + kNewPointsFile;
  const NormalsJob job{pointsPath, newPath, stationOf(conversion.sources), conversion.options, conversion.control};
  const std::uint64_t bytes = addNormals(job, info, hierarchy);
  // The journal's chunks are in the file without normals, which is needed until the store is complete.
  fs::rename(pointsPath, folder.builtPointsPath());
  fs::rename(newPath, pointsPath);
  return bytes + fs::file_size(pointsPath);
}

/// All stages from reading the points on. The store is whole then, but not published.
void buildStore(const Conversion& conversion, Session& session, StageClock& clock, ConvertReport& report) {
  SpilledScan scan = readInputs(conversion, session, clock);
  checkCounts(conversion.sources, conversion.options.source.skipDamaged, scan.all);

  clock.begin(stage::kBuild);
  const BuildContext context{describeStore(conversion, scan.survey, scan.all), scan.format,
                             conversion.options.lodColour, pointsAtOnce(scan.chunkLimit)};
  std::vector<ChunkRecord> found = readChunks(conversion.journal);
  std::vector<WrittenChunk> written;
  for (ChunkRecord& chunk : found) written.push_back(std::move(chunk.written));
  NodeSink sink(session.folder().path(), written);
  written = {};
  found.resize(sink.chunksFound());
  std::vector<ChunkTop> tops = buildChunks(conversion, context, scan.all, std::move(found), sink);
  scan = {};
  clock.begin(stage::kMerge);
  mergeChunks(conversion, context, std::move(tops), sink);

  clock.begin(stage::kWrite);
  Hierarchy hierarchy = sink.finish();
  StoreInfo info = context.info;
  info.nodes = hierarchy.nodes.size();
  for (const NodeRecord& node : hierarchy.nodes) info.levels = std::max(info.levels, NodeKey{node.key}.level() + 1);
  std::uint64_t normalBytes = 0;
  if (normalsMissing(info, conversion.options, conversion.control)) {
    clock.begin(stage::kNormals);
    normalBytes = writeNormals(conversion, session.folder(), info, hierarchy);
    clock.begin(stage::kWrite);
  }
  const std::string& folder = session.folder().path();
  writeStoreFiles(folder, info, hierarchy, fs::file_size(folder + "/" + kPointsFile));
  report.tempPeakBytes = std::max(conversion.spill.peakBytes() + conversion.journal.bytes(), normalBytes);
  appendComplete(conversion.journal);
  conversion.spill.discard();
}

/// Warns of scans without points and of disks without room.
void checkInputs(const Sources& sources, const ConvertOptions& options, const ConvertControl& control) {
  for (const auto& source : sources) {
    if (source->info().pointCount == 0 && sources.size() == 1) throw Error(source->info().path, "has no points");
    if (source->info().pointCount == 0) control.warn(source->info().path + ": has no points");
  }
  const std::string storeFolder = folderOf(options.output);
  const std::string& tempFolder = options.tempFolder.empty() ? storeFolder : options.tempFolder;
  for (const std::string& warning : roomWarnings(storeFolder, tempFolder, usualDiskNeed(sources)))
    control.warn(warning);
}

/// Builds the store of sources that are open. `clock` has begun to time the survey.
void convertOpen(const Sources& sources, const ConvertOptions& options, const ConvertControl& control,
                 StageClock& clock, ConvertReport& report) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(options.threads));  // more than there are cores, if asked
  checkInputs(sources, options, control);
  for (const auto& source : sources) report.inputBytes += source->info().fileBytes;

  Session session(sources, options);
  try {
    if (!session.isComplete())
      buildStore({sources, options, control, session.spill(), session.journal()}, session, clock, report);
  } catch (const Stopped&) {
    session.keep();
    throw;
  } catch (const fs::filesystem_error& failure) {  // a file of the building folder is gone
    throw Error(failure.path1().string(), failure.code().message());
  }
  session.folder().keep();  // a finished store is not thrown away, whatever its name runs into
  session.folder().publish();
  clock.end();
  reportStore(Store(options.output), report);
}

/// Fills in what `asked` leaves to defaults. Throws Error for folders that cannot be written to.
ConvertOptions completed(const ConvertOptions& asked) {
  ConvertOptions options = asked;
  while (options.output.size() > 1 && options.output.back() == '/') options.output.pop_back();
  options.threads = threadsOf(options);
  options.source.memoryBytes = options.memoryBytes;
  checkOutput(options.output, options.force);
  if (!options.tempFolder.empty() && !fs::is_directory(options.tempFolder))
    throw Error(options.tempFolder, "is no folder for temporary points");
  return options;
}

}  // namespace

ConvertReport convert(const ConvertOptions& asked, const ConvertControl& control) {
  const ConvertOptions options = completed(asked);
  ConvertReport report;
  StageClock clock(report.stages, control);
  clock.begin(stage::kSurvey);
  SourceOptions source = options.source;
  source.stop = control.stop;
  convertOpen(openScans(options.inputs, source), options, control, clock, report);
  return report;
}

ConvertReport convert(const Sources& sources, const ConvertOptions& asked, const ConvertControl& control) {
  ConvertReport report;
  StageClock clock(report.stages, control);
  clock.begin(stage::kSurvey);
  convertOpen(sources, completed(asked), control, clock, report);
  return report;
}

}  // namespace strata
