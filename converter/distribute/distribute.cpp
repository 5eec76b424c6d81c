#include "converter/distribute/distribute.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

#include "converter/distribute/point_packer.h"
#include "converter/distribute/run_sorter.h"
#include "converter/distribute/split.h"

namespace strata {
namespace {

using Sources = std::vector<std::unique_ptr<PointSource>>;

constexpr std::size_t kLeastRun = 65536, kMostRun = 1 << 20;    // points
constexpr std::uint64_t kTaskPoints = std::uint64_t{1} << 20;   // about; what a journal record is written for
constexpr std::uint64_t kReaderBytes = std::uint64_t{4} << 20;  // of a thread besides its run: blocks, decoder
constexpr std::uint64_t kProgressPoints = 1 << 17;

/// Consecutive parts of the sources that are read by one thread and journaled together.
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

/// What is counted of the points of a task, and of all.
class Tally {
 public:
  explicit Tally(const PointLayout& layout) : stats_(layout) { clear(); }

  void clear() {
    stats_.clear();
    low_.fill(std::numeric_limits<std::uint64_t>::max());
    high_.fill(0);
    sources_.clear();
  }
  void add(std::size_t source, const PointPacker& packer, const PackedFormat& format,
           const AttributeVariation& variation) {
    if (sources_.empty() || sources_.back().source != source) sources_.push_back({source, 0, 0});
    sources_.back().kept += packer.count();
    sources_.back().skipped += packer.skipped();
    if (packer.count() == 0) return;
    stats_.gather(packer.points() + format.positionBytes(), format.stride(), packer.count(), variation);
    addBounds(packer.low(), packer.high());
  }
  void write(RecordWriter& record) const {
    record.put(low_);
    record.put(high_);
    record.putAll(std::span(sources_));
    stats_.write(record);
  }
  void addFrom(RecordReader record) {
    const auto low = record.get<std::array<std::uint64_t, 3>>();
    const auto high = record.get<std::array<std::uint64_t, 3>>();
    addBounds(low, high);
    const std::vector<SourceCount> counts = record.getAll<SourceCount>();
    sources_.insert(sources_.end(), counts.begin(), counts.end());
    stats_.addFrom(record);
  }
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
  struct SourceCount {
    std::uint64_t source, kept, skipped;
  };
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

int firstLevel(std::uint64_t points, std::uint64_t limit, int cubeBits) {
  if (points <= limit) return 0;
  const double ratio = static_cast<double>(points) / static_cast<double>(limit);
  return std::min({static_cast<int>(std::ceil(std::log2(ratio) * 0.5)) + 2, CellGrid::kMostLevels, cubeBits});
}

/// Reads every source once into the first set.
class Reading {
 public:
  Reading(const Sources& sources, const Survey& frame, const PackedFormat& format, Workspace work,
          const ConvertControl& control, Distribution& out)
      : sources_(sources),
        frame_(frame),
        format_(format),
        work_(work),
        control_(control),
        out_(out),
        parts_(partsOf(sources)),
        tasks_(tasksOf(sources, parts_)),
        isDone_(tasks_.size(), 0),
        total_(frame.layout) {}

  void takeUpJournal() {
    for (const Journal::Place& place : work_.journal.found()) {
      if (place.kind != RecordKind::runs) continue;
      RunsRecord record = readRuns(work_.journal, place);
      if (record.head.set != 0) continue;
      if (record.head.task >= tasks_.size()) throw Error(work_.journal.path(), "tells of parts that there are not");
      isDone_[record.head.task] = 1;
      total_.addFrom(RecordReader(record.extra));
      donePoints_ += keep(record.written);
    }
  }

  void run(const RunPlan& plan) {
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
    out_.outsideCube = outside_;
    total_.report(sources_.size(), out_);
  }

 private:
  void work(std::size_t runPoints) {
    // Tasks are taken in order, so that one slow file at the end does not wait behind a single thread.
    RunSorter sorter(format_, runPoints, work_.spill);
    Tally tally(frame_.layout);
    for (std::size_t t = nextTask_++; !failed_ && !outside_ && t < tasks_.size(); t = nextTask_++) {
      if (isDone_[t] != 0) continue;
      sorter.aim(out_.sets.front().grid, static_cast<std::uint64_t>(t) << 24);
      tally.clear();
      for (std::size_t p = tasks_[t].firstPart; p < tasks_[t].endPart; ++p) readPart(parts_[p], sorter, tally);
      if (failed_ || outside_) return;
      std::vector<WrittenRun> written = sorter.finish();
      RecordWriter record;
      tally.write(record);
      appendRuns(work_.journal, {0, t}, record, written);
      const std::lock_guard lock(mutex_);
      total_.addFrom(RecordReader(record.bytes()));
      keep(written);
    }
  }

  void readPart(const Part& part, RunSorter& sorter, Tally& tally) {
    PointPacker packer(frame_, format_, *sources_[part.source], frame_.mappings[part.source]);
    const auto reader = packer.open(part.part);
    AttributeVariation variation;
    std::uint64_t unseen = 0;  // by the progress line
    while (!outside_ && !failed_ && packer.read(*reader, RunSorter::kBlockPoints)) {
      control_.checkStop();
      if (packer.outside()) {
        outside_ = true;
        return;
      }
      if (packer.count() > 0)
        findVariation(packer.points() + format_.positionBytes(), format_.stride(), format_.attributeBytes,
                      packer.count(), variation);
      tally.add(part.source, packer, format_, variation);
      sorter.add(packer.points(), packer.count(), variation);
      unseen += packer.count() + packer.skipped();
      if (unseen < kProgressPoints) continue;
      control_.progress({stage::kDistribute, donePoints_ += unseen, frame_.claimedPoints});
      unseen = 0;
    }
    donePoints_ += unseen;
  }

  /// Adds runs to the set of all points; returns how many points they have.
  std::uint64_t keep(std::vector<WrittenRun>& written) {
    RunSet& set = out_.sets.front();
    std::uint64_t points = 0;
    for (WrittenRun& w : written) {
      for (const RunCell& cell : w.cells) set.points.at(cell.cell) += cell.points;
      points += w.run.points;
      set.runs.push_back(std::move(w.run));
    }
    return points;
  }

  const Sources& sources_;
  const Survey& frame_;
  const PackedFormat format_;
  const Workspace work_;
  const ConvertControl& control_;
  Distribution& out_;  ///< guarded by mutex_ while threads run
  const std::vector<Part> parts_;
  const std::vector<Task> tasks_;
  std::vector<char> isDone_;  ///< by task, as the journal has it
  std::mutex mutex_;
  Tally total_;  ///< guarded by mutex_
  std::atomic<std::uint64_t> donePoints_{0};
  std::atomic<std::size_t> nextTask_{0};
  std::atomic<bool> outside_{false}, failed_{false};
};

}  // namespace

RunPlan planRuns(const PackedFormat& format, const ConvertOptions& options) {
  const std::uint64_t budget = options.memoryBytes / 4;
  const std::uint64_t share = budget / static_cast<std::uint64_t>(options.threads);
  const std::uint64_t perPoint = RunSorter::memoryBytes(format, kLeastRun) / kLeastRun + 1;
  RunPlan plan;
  plan.runPoints =
      std::clamp<std::size_t>(share > kReaderBytes ? (share - kReaderBytes) / perPoint : 0, kLeastRun, kMostRun);
  const std::uint64_t worker = RunSorter::memoryBytes(format, plan.runPoints) + kReaderBytes;
  plan.workers =
      static_cast<int>(std::clamp<std::uint64_t>(budget / worker, 1, static_cast<std::uint64_t>(options.threads)));
  return plan;
}

Distribution distribute(const Sources& sources, const Survey& frame, const PackedFormat& format,
                        std::uint64_t bucketLimit, const ConvertOptions& options, Workspace work,
                        const ConvertControl& control) {
  Distribution out;
  out.sets.emplace_back(
      CellGrid(NodeKey{}, firstLevel(frame.claimedPoints, bucketLimit, frame.cubeBits), frame.cubeBits));
  Reading reading(sources, frame, format, work, control, out);
  reading.takeUpJournal();
  reading.run(planRuns(format, options));
  if (out.outsideCube || out.points == 0) return out;
  RunSet& set = out.sets.front();
  std::sort(set.runs.begin(), set.runs.end(), [](const Run& a, const Run& b) { return a.sequence < b.sequence; });
  splitAndMerge(out, frame, format, bucketLimit, options, work, control);
  return out;
}

}  // namespace strata
