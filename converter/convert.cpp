#include <malloc.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <random>
#include <thread>

#include "converter/build/build_chunks.h"
#include "converter/build/chunk_builder.h"
#include "converter/build/merge.h"
#include "converter/build/node_sink.h"
#include "converter/distribute/distribute.h"
#include "converter/journal/build_folder.h"
#include "converter/journal/conversion_terms.h"
#include "converter/journal/disk_room.h"
#include "converter/normals/add_normals.h"
#include "converter/options.h"
#include "converter/survey/survey.h"
#include "core/error.h"
#include "core/version.h"
#include "io/open_scans.h"
#include "io/store/store_files.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

/// So many of the largest chunks are built at the same time, or more smaller ones, and share the memory cap; the number
/// is fixed so that the chunks, and with them the store's bytes, do not depend on the number of threads.
constexpr int kChunksAtOnce = 4;
/// No chunk is larger, however much memory there is: stopping waits for the chunks that are being built.
constexpr std::uint64_t kMostChunkPoints = 3'000'000;
/// With chunks of fewer points than this the tree above them would outweigh them.
constexpr std::uint64_t kLeastChunkPoints = 20'000;

/// Points of a chunk, so that all of what is in memory while building stays under the cap. Building a chunk takes its
/// points, what chunk_builder.h says, and its finished nodes; what grows with the scan is taken off first: the
/// hierarchy's records (twice while their vector grows) and the cursors of the runs.
std::uint64_t chunkPointLimit(const ConvertOptions& options, const PackedFormat& format, std::uint64_t points) {
  constexpr std::uint64_t kProgramBytes = std::uint64_t{160} << 20;
  constexpr std::uint64_t kRunBytes = 2048;  // for about a million points
  const std::uint64_t nodes = 4 * points / options.nodePoints + 1;
  const std::uint64_t growing = 2 * sizeof(NodeRecord) * nodes + (points >> 20) * kRunBytes;
  const std::uint64_t perPoint = 2 * kChunksAtOnce * (chunkBytesPerPoint(format) + format.stride());
  const std::uint64_t least = kProgramBytes + growing + kLeastChunkPoints * perPoint;
  if (options.memoryBytes < least)
    throw Error("--memory", "is too little for so many points in nodes of so few, found " +
                                std::to_string(options.memoryBytes >> 20) + "M (expected at least " +
                                std::to_string((least >> 20) + 1) + "M)");
  return std::min(kMostChunkPoints, (options.memoryBytes - kProgramBytes - growing) / perPoint);
}

/// Times one stage after the other.
class StageClock {
 public:
  StageClock(ConvertReport& report, const ConvertControl& control) : report_(report), control_(control) {}
  void begin(const char* stage) {
    end();
    stage_ = stage;
    control_.progress({stage, 0, 0});
  }
  void end() {
    const auto now = std::chrono::steady_clock::now();
    const double cpu = cpuSeconds();
    if (stage_ != nullptr)
      report_.stages.push_back({stage_, std::chrono::duration<double>(now - begin_).count(), cpu - cpuBegin_});
    stage_ = nullptr;
    begin_ = now;
    cpuBegin_ = cpu;
  }

 private:
  ConvertReport& report_;
  const ConvertControl& control_;
  const char* stage_ = nullptr;
  std::chrono::steady_clock::time_point begin_;
  double cpuBegin_ = 0.0;
};

using Sources = std::vector<std::unique_ptr<PointSource>>;

PackedFormat packedFormat(const Survey& frame) { return {frame.cubeBits > 32, frame.layout.stride()}; }

/// Sources that have been measured, and whether they all had to be because the first reading showed headers to lie.
struct Measured {
  std::vector<std::optional<MeasuredSource>> sources;
  bool all = false;
};

void appendMeasured(Journal& journal, const Measured& measured) {
  RecordWriter record;
  record.put(measured.all);
  for (const std::optional<MeasuredSource>& source : measured.sources) {
    record.put(source.has_value());
    record.put(source.value_or(MeasuredSource{}));
  }
  journal.append(RecordKind::measured, record.bytes());
}

bool findMeasured(const Journal& journal, Measured& out) {
  for (const Journal::Place& place : journal.found()) {
    if (place.kind != RecordKind::measured) continue;
    const std::vector<std::byte> payload = journal.payload(place);
    RecordReader record(payload);
    out.all = record.get<bool>();
    for (std::optional<MeasuredSource>& source : out.sources) {
      const bool has = record.get<bool>();
      source = record.get<MeasuredSource>();
      if (!has) source.reset();
    }
    return true;
  }
  return false;
}

void measure(const Sources& sources, bool all, const ConvertOptions& options, const ConvertControl& control,
             Measured& out) {
  out.all = all;
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (sources[i]->info().pointCount == 0)
      out.sources[i] = MeasuredSource{};
    else if (all || !headerBoundsUsable(sources[i]->info()))
      out.sources[i] = measureSource(*sources[i], options.threads, control);
}

/// Reads the inputs into buckets. Where headers cannot be believed their points are read once more for their extent.
Distribution readInputs(const Sources& sources, const ConvertOptions& options, Survey& frame, Workspace work,
                        std::uint64_t journalHead, StageClock& clock, const ConvertControl& control) {
  Measured measured{std::vector<std::optional<MeasuredSource>>(sources.size()), false};
  if (!findMeasured(work.journal, measured)) {
    if (std::any_of(sources.begin(), sources.end(), [](const auto& source) {
          return source->info().pointCount > 0 && !headerBoundsUsable(source->info());
        }))
      clock.begin(stage::kMeasure);
    measure(sources, false, options, control, measured);
    appendMeasured(work.journal, measured);
  }
  clock.begin(stage::kDistribute);
  for (;;) {
    frame = survey(sources, measured.sources);
    const PackedFormat format = packedFormat(frame);
    Distribution all = distribute(sources, frame, format, chunkPointLimit(options, format, frame.claimedPoints),
                                  options, work, control);
    const double extent = glm::max(all.bounds.size().x, glm::max(all.bounds.size().y, all.bounds.size().z));
    const bool farTooLarge = all.points > 0 && extent + 1.0 <= std::ldexp(1.0, frame.cubeBits - 2);
    if (measured.all || (!all.outsideCube && !farTooLarge)) return all;
    all = {};
    work.journal.rewind(journalHead);
    work.spill.truncate(0);
    measure(sources, true, options, control, measured);
    appendMeasured(work.journal, measured);
  }
}

/// Damage that a reader did not notice itself shows as a count that is too low.
void checkCounts(const Sources& sources, const ConvertOptions& options, Distribution& all) {
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const SourceInfo& info = sources[s]->info();
    const std::uint64_t read = all.sourcePoints[s] + all.sourceSkipped[s];
    if (read >= info.pointCount) continue;
    if (!options.source.skipDamaged)
      throw Error(info.path, "the file ends early, found " + std::to_string(read) + " points (expected " +
                                 std::to_string(info.pointCount) + "); --skip-damaged converts what is there");
    all.sourceSkipped[s] += info.pointCount - read;
  }
  if (all.points == 0) throw Error(sources.front()->info().path, "has no point with finite coordinates");
}

StoreInfo storeInfo(const Sources& sources, const ConvertOptions& options, const Survey& frame,
                    const Distribution& all) {
  StoreInfo info;
  info.program = "strata " + version();
  info.points = all.points;
  info.bounds.min = frame.grid.offset + frame.grid.scale * all.bounds.min;
  info.bounds.max = frame.grid.offset + frame.grid.scale * all.bounds.max;
  info.grid = frame.grid;
  info.cubeBits = frame.cubeBits;
  info.crs = frame.crs;
  info.layout = frame.layout;
  info.ranges = all.ranges;
  info.nodePoints = options.nodePoints;
  info.sampling = samplingName(options.sampling);
  info.las = frame.las;
  if (const int rgb = frame.layout.find(attribute::kRgb); rgb >= 0)
    info.colourShift = all.ranges[static_cast<std::size_t>(rgb)].max > 255.0 ? 8 : 0;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const SourceInfo& source = sources[s]->info();
    info.sources.push_back({source.path, source.format, all.sourcePoints[s], all.sourceSkipped[s]});
    info.skipped += all.sourceSkipped[s];
  }
  return info;
}

/// A place for temporary points that no other conversion has.
std::string newSpillPath(const ConvertOptions& options) {
  if (options.tempFolder.empty()) return {};
  std::random_device random;
  const std::string name = fs::path(options.output).filename().string() + "-" + std::to_string(random()) + ".spill";
  return fs::absolute(fs::path(options.tempFolder) / name).string();
}

/// Cuts off and punches out what was written to the spill but did not get into the journal.
void dropStrays(Workspace work) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> known;
  for (const Journal::Place& place : work.journal.found())
    if (place.kind == RecordKind::runs) {
      for (const WrittenRun& w : readRuns(work.journal, place).written)
        known.emplace_back(w.run.offset, w.run.offset + w.run.points * w.run.shape.stride());
    } else if (place.kind == RecordKind::chunk) {
      const Spill::Handle top = readChunkTop(work.journal, place);
      known.emplace_back(top.offset, top.offset + top.bytes);
    }
  std::sort(known.begin(), known.end());
  std::uint64_t end = 0;
  for (const auto& [first, last] : known) {
    work.spill.release(end, first);
    end = std::max(end, last);
  }
  work.spill.truncate(end);
}

/// The folder, the journal and the spill of a conversion; taken up where an interrupted one left them.
class Session {
 public:
  Session(const Sources& sources, const ConvertOptions& options)
      : folder(options.output, options.force, options.resume) {
    folder.keep(options.resume);  // what cannot be resumed stays as it is
    journal.emplace(folder.journalPath());
    JournalHead head{newSpillPath(options), termsOf(sources, options)};
    if (journal->found().empty()) {
      appendHead(*journal, head);
    } else {
      const JournalHead begun = readHead(*journal);
      checkSameTerms(folder.path(), begun.terms, head.terms);
      head.spillPath = begun.spillPath;
    }
    headEnd = journal->found().empty() ? journal->bytes() : journal->found()[0].offset + journal->found()[0].bytes;
    const std::string path = head.spillPath.empty() ? folder.spillPath() : head.spillPath;
    complete = !journal->found().empty() && journal->found().back().kind == RecordKind::complete;
    if (complete) {
      std::error_code ignored;
      fs::remove(path, ignored);
      return;
    }
    folder.putBackBuiltPoints();
    const bool begun = journal->found().size() > 1 || fs::exists(path);
    spill.emplace(path, begun ? Spill::Open::existing : Spill::Open::create);
    if (begun) dropStrays({*spill, *journal});
    folder.keep(false);
  }

  Workspace workspace() { return {*spill, *journal}; }
  /// Leaves everything for a conversion to go on with.
  void keep() {
    spill->keep();
    folder.keep();
  }

  BuildFolder folder;
  std::optional<Journal> journal;
  std::optional<Spill> spill;
  std::uint64_t headEnd = 0;  ///< of the journal's first record
  bool complete = false;      ///< nothing is left to do but publishing; there is no spill
};

/// What the report says of the store that has been published.
void reportStore(const Store& store, ConvertReport& report) {
  report.points = store.info().points;
  report.nodes = store.info().nodes;
  report.skipped = store.info().skipped;
  for (const NodeRecord& node : store.hierarchy().nodes) {
    const auto level = static_cast<std::size_t>(NodeKey{node.key}.level());
    report.nodesByLevel.resize(std::max(report.nodesByLevel.size(), level + 1));
    report.pointsByLevel.resize(report.nodesByLevel.size());
    ++report.nodesByLevel[level];
    report.pointsByLevel[level] += node.pointCount;
  }
  report.planes = planeSizes(store);
  for (const char* file : {kInfoFile, kHierarchyFile, kPointsFile})
    report.outputBytes += fs::file_size(store.path() + "/" + file);
}

/// All stages from reading the points on; the store is whole then, but not published.
void buildStore(const Sources& sources, const ConvertOptions& options, const ConvertControl& control, Session& session,
                StageClock& clock, ConvertReport& report) {
  const Workspace work = session.workspace();
  Survey surveyed;
  Distribution all = readInputs(sources, options, surveyed, work, session.headEnd, clock, control);
  checkCounts(sources, options, all);

  clock.begin(stage::kBuild);
  const BuildFrame frame{storeInfo(sources, options, surveyed, all), packedFormat(surveyed), options.sampling,
                         options.lodColour};
  std::vector<ChunkRecord> found = readChunks(work.journal);
  std::vector<NodeSink::Written> written;
  for (ChunkRecord& chunk : found) written.push_back(std::move(chunk.written));
  NodeSink sink(session.folder.path(), written);
  written = {};
  found.resize(sink.chunksFound());
  const std::uint64_t pointsAtOnce =
      (kChunksAtOnce - 1) * chunkPointLimit(options, packedFormat(surveyed), surveyed.claimedPoints);
  std::vector<ChunkTop> tops = buildChunks(frame, all, std::move(found), pointsAtOnce, options, work, sink, control);
  all = {};
  clock.begin(stage::kMerge);
  mergeChunks(frame, std::move(tops), pointsAtOnce, options.threads, work.spill, sink, control);

  clock.begin(stage::kWrite);
  Hierarchy hierarchy = sink.finish();
  StoreInfo info = frame.info;
  info.nodes = hierarchy.nodes.size();
  for (const NodeRecord& node : hierarchy.nodes) info.levels = std::max(info.levels, NodeKey{node.key}.level() + 1);
  const std::string pointsPath = session.folder.path() + "/" + kPointsFile;
  std::uint64_t normalBytes = 0;
  if (normalsMissing(info, options, control)) {
    clock.begin(stage::kNormals);
    const std::string newPath = session.folder.path() + "/" + kNewPointsFile;
    normalBytes = addNormals(info, hierarchy, pointsPath, newPath, viewpointOf(sources), options, control);
    fs::rename(pointsPath, session.folder.builtPointsPath());  // what the journal tells of, until the end
    fs::rename(newPath, pointsPath);
    normalBytes += fs::file_size(pointsPath);
    clock.begin(stage::kWrite);
  }
  writeStoreFiles(session.folder.path(), info, hierarchy, fs::file_size(pointsPath));
  report.tempPeakBytes = std::max(work.spill.peakBytes() + work.journal.bytes(), normalBytes);
  work.journal.append(RecordKind::complete, {});
  work.spill.discard();
}

/// Builds the store of sources that are open; `clock` has begun to time the survey.
void convertOpen(const Sources& sources, const ConvertOptions& options, const ConvertControl& control,
                 StageClock& clock, ConvertReport& report) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(options.threads));  // more than there are cores, if asked
  for (const auto& source : sources) {
    report.inputBytes += source->info().fileBytes;
    if (source->info().pointCount == 0 && sources.size() == 1) throw Error(source->info().path, "has no points");
    if (source->info().pointCount == 0) control.warn(source->info().path + ": has no points");
  }
  const std::string storeFolder = folderOf(options.output);
  for (const std::string& warning :
       roomWarnings(storeFolder, options.tempFolder.empty() ? storeFolder : options.tempFolder, usualDiskNeed(sources)))
    control.warn(warning);

  Session session(sources, options);
  try {
    if (!session.complete) buildStore(sources, options, control, session, clock, report);
  } catch (const Stopped&) {
    session.keep();
    throw;
  } catch (const fs::filesystem_error& failure) {  // a file of the building folder is gone
    throw Error(failure.path1().string(), failure.code().message());
  }
  session.folder.keep();  // a finished store is not thrown away, whatever its name runs into
  session.folder.publish();
  clock.end();
  reportStore(Store(options.output), report);
}

/// What was asked, with everything said that had a default; refuses what cannot be written to.
ConvertOptions completed(const ConvertOptions& asked) {
  ConvertOptions options = asked;
  while (options.output.size() > 1 && options.output.back() == '/') options.output.pop_back();
  options.threads = threadsOf(options);
  options.source.memoryBytes = options.memoryBytes;
  checkOutput(options.output, options.force);
  if (!options.tempFolder.empty() && !fs::is_directory(options.tempFolder))
    throw Error(options.tempFolder, "is no folder for temporary points");
  // Freed blocks of points go back to the system at once: the cap is on resident memory.
  ::mallopt(M_MMAP_THRESHOLD, 1 << 20);
  return options;
}

}  // namespace

double cpuSeconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

int threadsOf(const ConvertOptions& options) {
  return options.threads > 0 ? options.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

ConvertReport convert(const ConvertOptions& asked, const ConvertControl& control) {
  const ConvertOptions options = completed(asked);
  ConvertReport report;
  StageClock clock(report, control);
  clock.begin(stage::kSurvey);
  SourceOptions source = options.source;
  source.stop = control.stop;
  convertOpen(openScans(options.inputs, source), options, control, clock, report);
  return report;
}

ConvertReport convert(const std::vector<std::unique_ptr<PointSource>>& sources, const ConvertOptions& asked,
                      const ConvertControl& control) {
  ConvertReport report;
  StageClock clock(report, control);
  clock.begin(stage::kSurvey);
  convertOpen(sources, completed(asked), control, clock, report);
  return report;
}

}  // namespace strata
