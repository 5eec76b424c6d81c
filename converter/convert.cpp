#include <malloc.h>
#include <sys/resource.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "converter/add_normals.h"
#include "converter/build_folder.h"
#include "converter/chunk_builder.h"
#include "converter/disk_room.h"
#include "converter/distribute.h"
#include "converter/merge.h"
#include "converter/node_sink.h"
#include "converter/options.h"
#include "converter/survey.h"
#include "core/error.h"
#include "io/store_files.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

/// Chunks that are built at the same time share the memory cap; the number is fixed so that the chunks, and with
/// them the store's bytes, do not depend on the number of threads.
constexpr int kChunksAtOnce = 4;
/// Memory that building a chunk takes: the packed points twice, keys and indices twice, and the payloads.
std::uint64_t chunkPointLimit(std::uint64_t memoryBytes, const PackedFormat& format) {
  constexpr std::uint64_t kProgramBytes = std::uint64_t{160} << 20;
  const std::uint64_t perPoint = 2 * format.stride() + 2 * 12 + 16;
  return (memoryBytes - kProgramBytes) / 2 / kChunksAtOnce / perPoint;
}

/// CPU time of the process so far, all threads.
double cpuSeconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
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

/// Reads the inputs into buckets. Where headers cannot be believed their points are read once more for their extent.
Distribution readInputs(const Sources& sources, const ConvertOptions& options, Survey& frame, Spill& spill,
                        StageClock& clock, const ConvertControl& control) {
  std::vector<std::optional<MeasuredSource>> measured(sources.size());
  bool measuring = false;
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (!headerBoundsUsable(sources[i]->info()) && sources[i]->info().pointCount > 0) {
      if (!measuring) clock.begin(stage::kMeasure);
      measuring = true;
      measured[i] = measureSource(*sources[i], options.threads, control);
    } else if (sources[i]->info().pointCount == 0) {
      measured[i] = MeasuredSource{};
    }
  clock.begin(stage::kDistribute);
  for (int attempt = 0;; ++attempt) {
    frame = survey(sources, measured);
    const PackedFormat format = packedFormat(frame);
    Distribution all =
        distribute(sources, frame, format, chunkPointLimit(options.memoryBytes, format), options, spill, control);
    const double extent = glm::max(all.bounds.size().x, glm::max(all.bounds.size().y, all.bounds.size().z));
    const bool farTooLarge = all.points > 0 && extent + 1.0 <= std::ldexp(1.0, frame.cubeBits - 2);
    if (attempt > 0 || (!all.outsideCube && !farTooLarge)) return all;
    all = {};
    spill.clear();
    for (std::size_t i = 0; i < sources.size(); ++i) measured[i] = measureSource(*sources[i], options.threads, control);
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
  info.program = std::string("strata ") + STRATA_VERSION;
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

/// Builds all chunks, several at a time, and writes them in order.
std::vector<ChunkTop> buildChunks(const BuildFrame& frame, std::vector<Bucket>& buckets, const ConvertOptions& options,
                                  Spill& spill, NodeSink& sink, const ConvertControl& control) {
  struct Work {
    NodeKey cell;
    std::vector<std::byte> points;
    BuiltChunk built;
    std::uint64_t count = 0;
  };
  std::vector<ChunkTop> tops;
  ScratchPool scratches;
  std::size_t next = 0;
  std::uint64_t done = 0;
  tbb::task_arena arena(options.threads);
  arena.execute([&] {
    tbb::parallel_pipeline(
        static_cast<std::size_t>(std::min(options.threads, kChunksAtOnce)),
        tbb::make_filter<void, std::shared_ptr<Work>>(tbb::filter_mode::serial_in_order,
                                                      [&](tbb::flow_control& flow) -> std::shared_ptr<Work> {
                                                        if (next == buckets.size()) {
                                                          flow.stop();
                                                          return nullptr;
                                                        }
                                                        control.checkStop();
                                                        Bucket& bucket = buckets[next++];
                                                        auto work = std::make_shared<Work>();
                                                        work->cell = bucket.cell;
                                                        work->count = bucket.points;
                                                        work->points.reserve(bucket.points * frame.format.stride());
                                                        for (Bucket::Block& block : bucket.blocks)
                                                          spill.take(block.handle, work->points);
                                                        bucket.blocks = {};
                                                        return work;
                                                      }) &
            tbb::make_filter<std::shared_ptr<Work>, std::shared_ptr<Work>>(
                tbb::filter_mode::parallel,
                [&](std::shared_ptr<Work> work) {
                  std::unique_ptr<ChunkScratch> scratch = scratches.lend();
                  work->built = buildChunk(frame, work->cell, std::move(work->points), *scratch);
                  scratches.giveBack(std::move(scratch));
                  return work;
                }) &
            tbb::make_filter<std::shared_ptr<Work>, void>(
                tbb::filter_mode::serial_in_order, [&](const std::shared_ptr<Work>& work) {
                  sink.write(std::move(work->built.nodes));
                  tops.push_back({work->cell, spill.put(work->built.topPoints), std::move(work->built.topChildren)});
                  control.progress({stage::kBuild, done += work->count, frame.info.points});
                }));
  });
  return tops;
}

void countLevels(const Hierarchy& hierarchy, ConvertReport& report) {
  for (const NodeRecord& node : hierarchy.nodes) {
    const auto level = static_cast<std::size_t>(NodeKey{node.key}.level());
    report.nodesByLevel.resize(std::max(report.nodesByLevel.size(), level + 1));
    report.pointsByLevel.resize(report.nodesByLevel.size());
    ++report.nodesByLevel[level];
    report.pointsByLevel[level] += node.pointCount;
  }
}

/// Builds the store of sources that are open; `clock` has begun to time the survey.
void convertOpen(const Sources& sources, const ConvertOptions& options, const ConvertControl& control,
                 StageClock& clock, ConvertReport& report) {
  for (const auto& source : sources) {
    report.inputBytes += source->info().fileBytes;
    if (source->info().pointCount == 0 && sources.size() == 1) throw Error(source->info().path, "has no points");
    if (source->info().pointCount == 0) control.warn(source->info().path + ": has no points");
  }
  const std::string storeFolder = folderOf(options.output);
  for (const std::string& warning :
       roomWarnings(storeFolder, options.tempFolder.empty() ? storeFolder : options.tempFolder, usualDiskNeed(sources)))
    control.warn(warning);

  BuildFolder folder(options.output, options.force);
  Spill spill(options.tempFolder.empty() ? folder.path() : options.tempFolder, options.memoryBytes / 8);
  Survey surveyed;
  Distribution all = readInputs(sources, options, surveyed, spill, clock, control);
  checkCounts(sources, options, all);

  clock.begin(stage::kBuild);
  const BuildFrame frame{storeInfo(sources, options, surveyed, all), packedFormat(surveyed), options.sampling,
                         options.lodColour};
  NodeSink sink(folder.path());
  std::vector<ChunkTop> tops = buildChunks(frame, all.buckets, options, spill, sink, control);
  clock.begin(stage::kMerge);
  mergeChunks(frame, std::move(tops), spill, sink, control);

  clock.begin(stage::kWrite);
  Hierarchy hierarchy = sink.finish();
  StoreInfo info = frame.info;
  info.nodes = hierarchy.nodes.size();
  for (const NodeRecord& node : hierarchy.nodes) info.levels = std::max(info.levels, NodeKey{node.key}.level() + 1);
  const std::string pointsPath = folder.path() + "/" + kPointsFile;
  std::uint64_t normalBytes = 0;
  if (normalsMissing(info, options, control)) {
    clock.begin(stage::kNormals);
    const std::string newPath = folder.path() + "/" + kNewPointsFile;
    normalBytes = addNormals(info, hierarchy, pointsPath, newPath, viewpointOf(sources), options, control);
    fs::rename(newPath, pointsPath);
    normalBytes += fs::file_size(pointsPath);
    clock.begin(stage::kWrite);
  }
  writeStoreFiles(folder.path(), info, hierarchy, fs::file_size(pointsPath));
  folder.publish();
  clock.end();

  report.points = info.points;
  report.nodes = info.nodes;
  report.skipped = info.skipped;
  countLevels(hierarchy, report);
  report.planes = planeSizes(Store(options.output));
  report.tempPeakBytes = std::max(spill.peakFileBytes(), normalBytes);
  for (const char* file : {kInfoFile, kHierarchyFile, kPointsFile})
    report.outputBytes += fs::file_size(options.output + "/" + file);
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

int threadsOf(const ConvertOptions& options) {
  return options.threads > 0 ? options.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

ConvertReport convert(const ConvertOptions& asked, const ConvertControl& control) {
  const ConvertOptions options = completed(asked);
  ConvertReport report;
  StageClock clock(report, control);
  clock.begin(stage::kSurvey);
  convertOpen(openSources(options.inputs, options.source), options, control, clock, report);
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
