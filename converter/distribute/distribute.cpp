#include "converter/distribute/distribute.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "converter/distribute/attribute_stats.h"
#include "converter/distribute/point_packer.h"
#include "converter/distribute/run_plan.h"
#include "converter/distribute/run_sorter.h"
#include "converter/distribute/split.h"
#include "converter/journal/records.h"
#include "core/error.h"
#include "core/mutex.h"

namespace strata {
namespace {

constexpr std::uint64_t kTaskPoints = std::uint64_t{1} << 20;  // a task has about as many points
constexpr std::uint64_t kProgressPoints = 1 << 17;             // between two reports of progress

/// Consecutive parts of the sources that one thread reads and journals together.
struct Task {
  std::size_t firstPart, endPart;
};
struct Part {
  std::size_t source, part;
};

std::vector<Part> partsOf(const Sources& sources) {
  std::vector<Part> parts;
  for (std::size_t s = 0; s < sources.size(); ++s)
    for (std::size_t p = 0; p < sources[s]->partCount(); ++p) parts.push_back({s, p});
  return parts;
}

/// Depends on nothing but the sources, so that a resumed conversion has the same tasks.
std::vector<Task> tasksOf(const Sources& sources, const std::vector<Part>& parts) {
  std::vector<Task> tasks;
  std::uint64_t inTask = kTaskPoints;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (inTask >= kTaskPoints) {
      tasks.push_back({p, p});
      inTask = 0;
    }
    tasks.back().endPart = p + 1;
    const PointSource& source = *sources[parts[p].source];
    inTask += (source.info().pointCount + source.partCount() - 1) / source.partCount();
  }
  return tasks;
}

/// Adds up statistics of the points of a task, or of all tasks. Used by one thread at a time.
class Tally {
 public:
  explicit Tally(const PointLayout& layout) : stats_(layout) { clear(); }

  void clear() {
    stats_.clear();
    low_.fill(std::numeric_limits<std::uint64_t>::max());
    high_.fill(0);
    sources_.clear();
  }
  /// Adds the points that `packer` has just packed.
  void add(std::size_t source, const PointPacker& packer, const PackedFormat& format,
           const AttributeVariation& variation) {
    if (sources_.empty() || sources_.back().source != source) sources_.push_back({source, 0, 0});
    sources_.back().kept += packer.count();
    sources_.back().skipped += packer.skipped();
    if (packer.count() == 0) return;
    stats_.gather(packer.points() + format.positionBytes(), format.stride(), packer.count(), variation);
    addBounds(packer.low(), packer.high());
  }
  void add(const PointCounts& counts) {
    addBounds(counts.low, counts.high);
    sources_.insert(sources_.end(), counts.sources.begin(), counts.sources.end());
    stats_.add(counts.attributes);
  }
  PointCounts counts() const { return {low_, high_, sources_, stats_.counts()}; }
  void report(std::size_t sources, Distribution& out) const {
    out.sourcePoints.assign(sources, 0);
    out.sourceSkipped.assign(sources, 0);
    for (const SourceCount& count : sources_) {
      if (count.source >= sources) throw Error("the journal tells of an input that there is not");
      out.sourcePoints[count.source] += count.kept;
      out.sourceSkipped[count.source] += count.skipped;
      out.points += count.kept;
    }
    out.ranges = stats_.ranges();
    if (out.points > 0)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        out.bounds.min[static_cast<int>(axis)] = static_cast<double>(low_[axis]);
        out.bounds.max[static_cast<int>(axis)] = static_cast<double>(high_[axis]);
      }
  }

 private:
  void addBounds(const std::array<std::uint64_t, 3>& low, const std::array<std::uint64_t, 3>& high) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low_[axis] = std::min(low_[axis], low[axis]);
      high_[axis] = std::max(high_[axis], high[axis]);
    }
  }

  AttributeStats stats_;
  std::array<std::uint64_t, 3> low_{}, high_{};
  std::vector<SourceCount> sources_;
};

/// Levels of the first set: cells of an even surface, which has four times the points in a cell of twice the side, stay
/// well within the limit.
int firstLevels(std::uint64_t points, std::uint64_t limit, int cubeBits) {
  if (points <= limit) return 0;
  const double ratio = static_cast<double>(points) / static_cast<double>(limit);
  return std::min({static_cast<int>(std::ceil(std::log2(ratio) * 0.5)) + 2, CellGrid::kMostLevels, cubeBits});
}

/// Reads every source once into the first set.
class Reading {
 public:
  Reading(const Conversion& conversion, const Survey& survey, RunSet& set)
      : conversion_(conversion),
        survey_(survey),
        format_(packedFormat(survey)),
        parts_(partsOf(conversion.sources)),
        tasks_(tasksOf(conversion.sources, parts_)),
        grid_(set.grid),
        isDone_(tasks_.size(), 0),
        set_(set),
        total_(survey.layout) {
    takeUpJournal();
  }

  /// Reads the parts that are left; true unless points lie outside the cube.
  bool run(const RunPlan& plan) {
    tbb::task_arena arena(plan.workers);
    arena.execute([&] {
      tbb::parallel_for(0, plan.workers, [&](int) {
        try {
          work(plan.runPoints);
        } catch (...) {
          failed_ = true;  // the others need not read on
          throw;
        }
      });
    });
    return !outside_;
  }

  void report(Distribution& out) STRATA_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    total_.report(conversion_.sources.size(), out);
  }

 private:
  void takeUpJournal() STRATA_EXCLUDES(mutex_) {
    const Journal& journal = conversion_.journal;
    for (const Journal::FoundRecord& found : journal.found()) {
      if (found.kind != RecordKind::runs) continue;
      RunsRecord record = readRuns(journal, found);
      if (record.set != 0) continue;
      if (record.task >= tasks_.size() || !record.counts)
        throw Error(journal.path(), "tells of parts that there are not");
      isDone_[record.task] = 1;
      donePoints_ += keep(std::move(record));
    }
  }

  /// Takes task after task in their order, so that one slow file at the end does not wait behind a single thread.
  void work(std::size_t runPoints) {
    RunSorter sorter(format_, runPoints, conversion_.spill);
    Tally tally(survey_.layout);
    for (std::size_t t = nextTask_++; !failed_ && !outside_ && t < tasks_.size(); t = nextTask_++) {
      if (isDone_[t] != 0) continue;
      sorter.aim(grid_, static_cast<std::uint64_t>(t) << 24);
      tally.clear();
      for (std::size_t p = tasks_[t].firstPart; p < tasks_[t].endPart; ++p) readPart(parts_[p], sorter, tally);
      if (failed_ || outside_) return;
      RunsRecord record{0, t, tally.counts(), sorter.finish()};
      appendRuns(conversion_.journal, record);
      keep(std::move(record));
    }
  }

  void readPart(const Part& part, RunSorter& sorter, Tally& tally) {
    const PointSource& source = *conversion_.sources[part.source];
    PointPacker packer(survey_, format_, source, survey_.mappings[part.source]);
    const auto reader = packer.open(part.part);
    AttributeVariation variation;
    std::uint64_t unreported = 0;
    while (!outside_ && !failed_ && packer.read(*reader, RunSorter::kBlockPoints)) {
      conversion_.control.checkStop();
      if (packer.outside()) {
        outside_ = true;
        return;
      }
      if (packer.count() > 0)
        findVariation(packer.points() + format_.positionBytes(), format_.stride(), format_.attributeBytes,
                      packer.count(), variation);
      tally.add(part.source, packer, format_, variation);
      sorter.add(packer.points(), packer.count(), variation);
      unreported += packer.count() + packer.skipped();
      if (unreported < kProgressPoints) continue;
      conversion_.control.progress({stage::kDistribute, donePoints_ += unreported, survey_.claimedPoints});
      unreported = 0;
    }
    donePoints_ += unreported;
  }

  /// Adds the points of a task to the set and returns how many they are.
  std::uint64_t keep(RunsRecord&& record) STRATA_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    total_.add(*record.counts);
    return set_.add(std::move(record.runs));
  }

  const Conversion& conversion_;
  const Survey& survey_;
  const PackedFormat format_;
  const std::vector<Part> parts_;
  const std::vector<Task> tasks_;
  const CellGrid grid_;       ///< of the set
  std::vector<char> isDone_;  ///< by task, as the journal found it; constant after construction

  Mutex mutex_;
  RunSet& set_ STRATA_GUARDED_BY(mutex_);
  Tally total_ STRATA_GUARDED_BY(mutex_);

  std::atomic<std::uint64_t> donePoints_{0};
  std::atomic<std::size_t> nextTask_{0};
  std::atomic<bool> outside_{false}, failed_{false};
};

}  // namespace

Distribution distribute(const Conversion& conversion, const Survey& survey, std::uint64_t chunkLimit) {
  Distribution out;
  out.sets.emplace_back(
      CellGrid(NodeKey{}, firstLevels(survey.claimedPoints, chunkLimit, survey.cubeBits), survey.cubeBits));
  {
    Reading reading(conversion, survey, out.sets.front());
    out.outsideCube = !reading.run(planRuns(packedFormat(survey), conversion.options));
    reading.report(out);
  }
  if (out.outsideCube || out.points == 0) return out;
  out.chunks = splitIntoChunks(conversion, survey, chunkLimit, out.sets);
  return out;
}

}  // namespace strata
