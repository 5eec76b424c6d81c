#include "converter/distribute/split.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "converter/distribute/point_packer.h"
#include "converter/distribute/run_plan.h"
#include "converter/distribute/run_sorter.h"
#include "converter/distribute/split_plan.h"
#include "converter/journal/records.h"
#include "core/error.h"
#include "core/mutex.h"

namespace strata {
namespace {

constexpr std::uint64_t kTaskPoints = std::uint64_t{1} << 19;  // a task has about as many points

/// The numbers of the tasks that the journal has, by run set.
using DoneTasks = std::deque<std::set<std::uint64_t>>;

/// Some points of a cell that is split, for one thread to move.
struct MoveTask {
  std::size_t set = 0;       ///< that the points go to
  std::uint64_t number = 0;  ///< among the tasks of that set
  const CellGrid* from = nullptr;
  std::vector<Stretch> stretches;
};

/// Hands out the points of the cells of some splits, cell after cell. Used by one thread at a time.
class MoveTasks {
 public:
  MoveTasks(std::vector<Split> splits, const std::deque<RunSet>& sets, const Journal& journal, const DoneTasks& done)
      : splits_(std::move(splits)), sets_(sets), journal_(journal), done_(done) {}

  /// Returns nothing when all points have been handed out.
  std::shared_ptr<MoveTask> next() {
    while (ready_.empty() && nextSplit_ < splits_.size()) makeTasks(splits_[nextSplit_++]);
    if (ready_.empty()) return nullptr;
    std::shared_ptr<MoveTask> task = std::move(ready_.front());
    ready_.pop_front();
    return task;
  }

 private:
  /// Cuts the points of one cell into tasks and leaves out those that are done.
  void makeTasks(const Split& split) {
    if (split.how.levels == 0) return;
    if (!cursor_ || cursorSet_ != split.how.set) {
      cursor_.emplace(sets_[split.how.set], journal_);
      cursorSet_ = split.how.set;
    }
    std::uint64_t number = 0, points = kTaskPoints;
    std::shared_ptr<MoveTask> task;
    for (Stretch& stretch : cursor_->take(split.how.cell, split.how.cell + 1)) {
      if (points >= kTaskPoints) {
        task = std::make_shared<MoveTask>(MoveTask{split.newSet, number++, &sets_[split.how.set].grid, {}});
        if (!done_[task->set].contains(task->number)) ready_.push_back(task);
        points = 0;
      }
      points += stretch.points;
      task->stretches.push_back(std::move(stretch));
    }
  }

  const std::vector<Split> splits_;
  const std::deque<RunSet>& sets_;
  const Journal& journal_;
  const DoneTasks& done_;
  std::size_t nextSplit_ = 0;
  std::optional<RunCursor> cursor_;
  std::size_t cursorSet_ = 0;
  std::deque<std::shared_ptr<MoveTask>> ready_;
};

/// Reads the points of a stretch and calls `see(packed points, count)` for each block of them.
template <typename See>
void forEachBlock(const Conversion& conversion, const PackedFormat& format, const CellGrid& grid,
                  const Stretch& stretch, See&& see) {
  StretchReader reader(conversion.spill, grid, format, stretch);
  std::vector<std::byte> scratch, points(RunSorter::kBlockPoints * format.stride());
  while (reader.left() > 0) {
    conversion.control.checkStop();
    const std::size_t count = std::min<std::uint64_t>(reader.left(), RunSorter::kBlockPoints);
    reader.read(count, scratch, points.data());
    see(points.data(), count);
  }
}

/// A box of grid integers; empty at first.
struct GridBounds {
  std::array<std::uint64_t, 3> low, high{};
  GridBounds() { low.fill(std::numeric_limits<std::uint64_t>::max()); }

  void add(const std::int64_t (&grid)[3]) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], static_cast<std::uint64_t>(grid[axis]));
      high[axis] = std::max(high[axis], static_cast<std::uint64_t>(grid[axis]));
    }
  }
  void add(const GridBounds& other) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], other.low[axis]);
      high[axis] = std::max(high[axis], other.high[axis]);
    }
  }
};

/// Splits the cells of run set after run set: plans the splits of all sets that are complete, journals them, and moves
/// their points, which completes the next sets.
class Splitter {
 public:
  Splitter(const Conversion& conversion, const Survey& survey, std::uint64_t chunkLimit, std::deque<RunSet>& sets)
      : conversion_(conversion),
        format_(packedFormat(survey)),
        limits_{chunkLimit, survey.cubeBits},
        runPlan_(planRuns(format_, conversion.options)),
        sets_(sets),
        plan_(survey.cubeBits) {
    takeUpJournal();
  }

  std::vector<Chunk> run() {
    // The sets [first, end) are complete and not yet split.
    for (std::size_t first = 0, end = 1; first < end;) {
      std::vector<Split> splits;
      std::size_t nextEnd = end;
      for (std::size_t set = first; set < end; ++set) {
        sets_[set].sortRuns();
        planSet(set);
        for (const Split& split : plan_.ofSet(set)) {
          if (split.how.levels > 0) nextEnd = std::max(nextEnd, split.newSet + 1);
          splits.push_back(split);
        }
      }
      move(std::move(splits));
      first = end;
      end = nextEnd;
    }
    return chunksOf(sets_, plan_, limits_.chunkPoints);
  }

 private:
  void takeUpJournal() {
    const Journal& journal = conversion_.journal;
    doneTasks_.resize(1);
    for (const Journal::FoundRecord& found : journal.found()) {
      if (found.kind == RecordKind::split) {
        addSplit(readSplit(journal, found));
      } else if (found.kind == RecordKind::runs) {
        RunsRecord record = readRuns(journal, found);
        if (record.set == 0) continue;  // distribute() has taken it up
        if (record.set >= sets_.size()) throw Error(journal.path(), "tells of a cell that was not split");
        doneTasks_[record.set].insert(record.task);
        sets_[record.set].add(std::move(record.runs));
      }
    }
  }

  void addSplit(const SplitRecord& how) {
    plan_.add(how, sets_);
    doneTasks_.resize(sets_.size());
  }

  /// Decides and journals how the crowded cells of a set are split, as far as the journal does not know yet.
  void planSet(std::size_t set) {
    std::optional<RunCursor> cursor;
    for (const CrowdedCell& crowded : crowdedCells(sets_[set], limits_)) {
      if (plan_.find(set, crowded.cell) != nullptr) continue;
      SplitRecord how{set, crowded.cell, sets_[set].grid.cell(crowded.cell), 0};
      if (crowded.dense) {
        if (!cursor) cursor.emplace(sets_[set], conversion_.journal);
        const GridBounds bounds = boundsOf(sets_[set].grid, cursor->take(crowded.cell, crowded.cell + 1));
        how.parent = smallestCell(how.parent, bounds.low, bounds.high, limits_);
      }
      how.levels = levelsOfSplit(sets_[set].points[crowded.cell], how.parent, limits_);
      appendSplit(conversion_.journal, how);
      addSplit(how);
    }
  }

  GridBounds boundsOf(const CellGrid& grid, const std::vector<Stretch>& stretches) const {
    tbb::enumerable_thread_specific<GridBounds> found;
    tbb::parallel_for(std::size_t{0}, stretches.size(), [&](std::size_t s) {
      GridBounds& bounds = found.local();
      forEachBlock(conversion_, format_, grid, stretches[s], [&](const std::byte* points, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
          std::int64_t position[3];
          format_.getPosition(points + i * format_.stride(), position);
          bounds.add(position);
        }
      });
    });
    GridBounds all;
    for (const GridBounds& bounds : found) all.add(bounds);
    return all;
  }

  void move(std::vector<Split> splits) {
    MoveTasks tasks(std::move(splits), sets_, conversion_.journal, doneTasks_);
    tbb::enumerable_thread_specific<RunSorter> sorters(
        [this] { return RunSorter(format_, runPlan_.runPoints, conversion_.spill); });
    const auto take = tbb::make_filter<void, std::shared_ptr<MoveTask>>(tbb::filter_mode::serial_in_order,
                                                                        [&](tbb::flow_control& flow) {
                                                                          conversion_.control.checkStop();
                                                                          std::shared_ptr<MoveTask> task = tasks.next();
                                                                          if (!task) flow.stop();
                                                                          return task;
                                                                        });
    const auto work = tbb::make_filter<std::shared_ptr<MoveTask>, void>(
        tbb::filter_mode::parallel, [&](const std::shared_ptr<MoveTask>& task) { moveTask(*task, sorters.local()); });
    tbb::task_arena arena(runPlan_.workers);
    arena.execute([&] { tbb::parallel_pipeline(static_cast<std::size_t>(runPlan_.workers), take & work); });
  }

  /// Sorts the points of a task into the new set, and gives back the disk that they had.
  void moveTask(const MoveTask& task, RunSorter& sorter) STRATA_EXCLUDES(mutex_) {
    AttributeVariation variation;
    sorter.aim(sets_[task.set].grid, task.number << 24);
    for (const Stretch& stretch : task.stretches)
      forEachBlock(conversion_, format_, *task.from, stretch, [&](const std::byte* points, std::size_t count) {
        findVariation(points + format_.positionBytes(), format_.stride(), format_.attributeBytes, count, variation);
        sorter.add(points, count, variation);
      });
    RunsRecord record{task.set, task.number, std::nullopt, sorter.finish()};
    appendRuns(conversion_.journal, record);
    {
      const MutexLock lock(mutex_);
      sets_[task.set].add(std::move(record.runs));
    }
    for (const Stretch& stretch : task.stretches) conversion_.spill.release(stretch.offset, stretch.end());
  }

  const Conversion& conversion_;
  const PackedFormat format_;
  const SplitLimits limits_;
  const RunPlan runPlan_;

  /// Threads that move points add runs to sets under `mutex_`. The number of sets, the grids, and the runs of the sets
  /// that points are moved from are constant meanwhile.
  std::deque<RunSet>& sets_;
  Mutex mutex_;

  // Used by the thread that calls run(); constant while points are moved.
  SplitPlan plan_;
  DoneTasks doneTasks_;
};

}  // namespace

std::vector<Chunk> splitIntoChunks(const Conversion& conversion, const Survey& survey, std::uint64_t chunkLimit,
                                   std::deque<RunSet>& sets) {
  Splitter splitter(conversion, survey, chunkLimit, sets);
  return splitter.run();
}

}  // namespace strata
