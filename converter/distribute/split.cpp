#include "converter/distribute/split.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <set>

#include "converter/distribute/run_sorter.h"
#include "core/error.h"

namespace strata {
namespace {

constexpr std::uint64_t kTaskPoints = std::uint64_t{1} << 19;  // about
/// A cell that holds this share of its set's points is likely to hold them in a corner again.
constexpr double kDenseShare = 0.75;

/// How a cell is split, as the journal has it.
struct Split {
  std::uint64_t set = 0, cell = 0;  ///< what is split
  std::uint64_t parent = 1;         ///< the smallest node that holds its points, as far as was looked
  std::int64_t levels = 0;          ///< of the new set below it; 0 = nothing left to split, the bucket is `parent`
};

using Corner = std::array<std::uint64_t, 3>;

class Splitter {
 public:
  Splitter(Distribution& all, const Survey& frame, const PackedFormat& format, std::uint64_t limit, const RunPlan& plan,
           Workspace work, const ConvertControl& control)
      : all_(all), frame_(frame), format_(format), limit_(limit), plan_(plan), work_(work), control_(control) {}

  void takeUpJournal() {
    for (const Journal::Place& place : work_.journal.found()) {
      if (place.kind == RecordKind::split) {
        const std::vector<std::byte> payload = work_.journal.payload(place);
        begin(RecordReader(payload).get<Split>());
      } else if (place.kind == RecordKind::runs) {
        RunsRecord record = readRuns(work_.journal, place);
        if (record.head.set == 0) continue;
        if (record.head.set >= all_.sets.size())
          throw Error(work_.journal.path(), "tells of a cell that was not split");
        keep(record.head, record.written);
      }
    }
  }

  /// Splits what is too large in the sets, set after set; those that come of it are among them.
  void run() {
    for (std::size_t first = 0, end = 1; first < end;) {
      for (std::size_t s = first; s < end; ++s)
        std::sort(all_.sets[s].runs.begin(), all_.sets[s].runs.end(),
                  [](const Run& a, const Run& b) { return a.sequence < b.sequence; });
      splitSets(first, end);
      std::size_t last = end;
      for (const auto& [from, split] : splits_)
        if (from.first >= first && from.first < end && split.first.levels > 0) last = std::max(last, split.second + 1);
      first = end;
      end = last;
    }
  }

  void fillBuckets() { emitSet(0); }

 private:
  struct Task {
    std::size_t set = 0;  ///< that the points go to
    std::uint64_t number = 0;
    const CellGrid* from = nullptr;
    std::vector<Extent> extents;
  };

  int room(NodeKey cell) const { return std::min(NodeKey::kDeepestLevel, frame_.cubeBits) - cell.level(); }

  /// Makes the new set, or remembers the bucket's node where there is none.
  void begin(const Split& split) {
    const std::lock_guard lock(mutex_);
    const auto key = std::pair(static_cast<std::size_t>(split.set), static_cast<std::size_t>(split.cell));
    splits_[key] = {split, all_.sets.size()};
    if (split.levels == 0) return;
    all_.sets.emplace_back(CellGrid(NodeKey{split.parent}, static_cast<int>(split.levels), frame_.cubeBits));
    doneTasks_.resize(all_.sets.size());
  }

  void keep(const RunsHead& head, std::vector<WrittenRun>& written) {
    const std::lock_guard lock(mutex_);
    RunSet& set = all_.sets[head.set];
    for (WrittenRun& w : written) {
      for (const RunCell& cell : w.cells) set.points.at(cell.cell) += cell.points;
      set.runs.push_back(std::move(w.run));
    }
    doneTasks_[head.set].insert(head.task);
  }

  /// The smallest node that holds all points of a cell.
  NodeKey tightNode(const RunSet& set, std::size_t cell) {
    RunCursor cursor(set, work_.journal);
    const std::vector<Extent> extents = cursor.take(cell, cell + 1);
    Corner low, high{};
    low.fill(std::numeric_limits<std::uint64_t>::max());
    std::mutex mutex;
    tbb::parallel_for(std::size_t{0}, extents.size(), [&](std::size_t e) {
      ExtentReader reader(work_.spill, set.grid, format_, extents[e]);
      std::vector<std::byte> scratch, points(RunSorter::kBlockPoints * format_.stride());
      Corner lowHere, highHere{};
      lowHere.fill(std::numeric_limits<std::uint64_t>::max());
      while (reader.left() > 0) {
        control_.checkStop();
        const std::size_t count = std::min<std::uint64_t>(reader.left(), RunSorter::kBlockPoints);
        reader.read(count, scratch, points.data());
        for (std::size_t i = 0; i < count; ++i) {
          std::int64_t grid[3];
          format_.getPosition(points.data() + i * format_.stride(), grid);
          for (std::size_t axis = 0; axis < 3; ++axis) {
            lowHere[axis] = std::min(lowHere[axis], static_cast<std::uint64_t>(grid[axis]));
            highHere[axis] = std::max(highHere[axis], static_cast<std::uint64_t>(grid[axis]));
          }
        }
      }
      const std::lock_guard lock(mutex);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], lowHere[axis]);
        high[axis] = std::max(high[axis], highHere[axis]);
      }
    });
    NodeKey node = set.grid.cell(cell);
    for (int bit = frame_.cubeBits - node.level() - 1; bit >= 0 && room(node) > 0; --bit) {
      int octant = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if ((low[axis] >> bit) != (high[axis] >> bit)) return node;
        octant = octant << 1 | static_cast<int>(low[axis] >> bit & 1);
      }
      node = node.child(octant);
    }
    return node;
  }

  /// Decides how to split a cell and journals it.
  void decide(std::size_t s, std::size_t cell, std::uint64_t setPoints) {
    const RunSet& set = all_.sets[s];
    const std::uint64_t points = set.points[cell];
    NodeKey parent = set.grid.cell(cell);
    if (static_cast<double>(points) >= kDenseShare * static_cast<double>(setPoints)) parent = tightNode(set, cell);
    const double ratio = static_cast<double>(points) / static_cast<double>(limit_);
    const int wanted = static_cast<int>(std::ceil(std::log2(ratio) * 0.5)) + 1;
    const int most = std::min(CellGrid::kMostLevels, room(parent));
    const Split split{s, cell, parent.code, most > 0 ? std::clamp(wanted, 1, most) : 0};
    RecordWriter record;
    record.put(split);
    work_.journal.append(RecordKind::split, record.bytes());
    begin(split);
  }

  /// Where the producer of tasks is.
  struct Producer {
    std::size_t set = 0, end = 0, cell = 0;
    std::uint64_t setPoints = 0;
    std::unique_ptr<RunCursor> cursor;
    std::vector<Extent> extents;  ///< of the cell, last first
    std::size_t child = 0;
    std::uint64_t number = 0;
  };
  /// The next task that is not done yet; false when there is none.
  bool produce(Producer& at, Task& task) {
    for (;;) {
      control_.checkStop();
      if (!at.extents.empty()) {
        task = {at.child, at.number++, &all_.sets[at.set].grid, {}};
        for (std::uint64_t points = 0; points < kTaskPoints && !at.extents.empty();) {
          points += at.extents.back().points;
          task.extents.push_back(std::move(at.extents.back()));
          at.extents.pop_back();
        }
        if (isDone(task)) continue;
        return true;
      }
      if (at.set == at.end) return false;
      const RunSet& set = all_.sets[at.set];
      if (!at.cursor) {
        at.cursor = std::make_unique<RunCursor>(set, work_.journal);
        at.setPoints = 0;
        for (const std::uint64_t points : set.points) at.setPoints += points;
      }
      while (at.cell < set.points.size() && (set.points[at.cell] <= limit_ || room(set.grid.cell(at.cell)) <= 0))
        ++at.cell;
      if (at.cell == set.points.size()) {
        at.cursor.reset();
        at.cell = 0;
        ++at.set;
        continue;
      }
      if (!splits_.contains({at.set, at.cell})) decide(at.set, at.cell, at.setPoints);
      const auto& [split, child] = splits_.at({at.set, at.cell});
      if (split.levels > 0) {
        at.child = child;
        at.number = 0;
        at.extents = at.cursor->take(at.cell, at.cell + 1);
        std::reverse(at.extents.begin(), at.extents.end());
      }
      ++at.cell;
    }
  }

  void splitSets(std::size_t first, std::size_t end) {
    Producer at;
    at.set = first;
    at.end = end;
    tbb::enumerable_thread_specific<RunSorter> sorters(
        [this] { return RunSorter(format_, plan_.runPoints, work_.spill); });
    tbb::task_arena arena(plan_.workers);
    arena.execute([&] {
      tbb::parallel_pipeline(static_cast<std::size_t>(plan_.workers),
                             tbb::make_filter<void, std::shared_ptr<Task>>(tbb::filter_mode::serial_in_order,
                                                                           [&](tbb::flow_control& flow) {
                                                                             auto task = std::make_shared<Task>();
                                                                             if (!produce(at, *task)) flow.stop();
                                                                             return task;
                                                                           }) &
                                 tbb::make_filter<std::shared_ptr<Task>, void>(
                                     tbb::filter_mode::parallel,
                                     [&](const std::shared_ptr<Task>& task) { sortTask(*task, sorters.local()); }));
    });
  }

  void sortTask(const Task& task, RunSorter& sorter) {
    std::vector<std::byte> scratch, points(RunSorter::kBlockPoints * format_.stride());
    AttributeVariation variation;
    sorter.aim(gridOf(task.set), task.number << 24);
    for (const Extent& extent : task.extents) {
      ExtentReader reader(work_.spill, *task.from, format_, extent);
      while (reader.left() > 0) {
        control_.checkStop();
        const std::size_t count = std::min<std::uint64_t>(reader.left(), RunSorter::kBlockPoints);
        reader.read(count, scratch, points.data());
        findVariation(points.data() + format_.positionBytes(), format_.stride(), format_.attributeBytes, count,
                      variation);
        sorter.add(points.data(), count, variation);
      }
    }
    std::vector<WrittenRun> written = sorter.finish();
    appendRuns(work_.journal, {task.set, task.number}, {}, written);
    keep({task.set, task.number}, written);
    for (const Extent& extent : task.extents)
      work_.spill.release(extent.offset, extent.offset + extent.points * extent.run->shape.stride());
  }

  bool isDone(const Task& task) {
    const std::lock_guard lock(mutex_);
    return doneTasks_[task.set].contains(task.number);
  }

  CellGrid gridOf(std::size_t set) {
    const std::lock_guard lock(mutex_);
    return all_.sets[set].grid;
  }

  void emitSet(std::size_t s) {
    const RunSet& set = all_.sets[s];
    std::vector<std::uint64_t> before(set.points.size() + 1);
    for (std::size_t c = 0; c < set.points.size(); ++c) before[c + 1] = before[c] + set.points[c];
    emitCells(s, before, 0, 0);
  }

  /// The largest cells whose points stay within the limit, from the top down: the node that is `index`-th of those
  /// `depth` levels below the set's.
  void emitCells(std::size_t s, const std::vector<std::uint64_t>& before, int depth, std::size_t index) {
    const CellGrid grid = all_.sets[s].grid;
    const int below = 3 * (grid.levels - depth);
    const std::size_t first = index << below, end = (index + 1) << below;
    const std::uint64_t points = before[end] - before[first];
    if (points == 0) return;
    Bucket bucket{{grid.parent.code << (3 * depth) | index}, points, s, first, end, false};
    if (points <= limit_) {
      all_.buckets.push_back(bucket);
    } else if (below > 0) {
      for (std::size_t octant = 0; octant < 8; ++octant) emitCells(s, before, depth + 1, index << 3 | octant);
    } else if (const auto split = splits_.find({s, first}); split != splits_.end() && split->second.first.levels > 0) {
      emitSet(split->second.second);
    } else {
      if (split != splits_.end()) bucket.cell = NodeKey{split->second.first.parent};
      bucket.sliced = true;
      all_.buckets.push_back(bucket);
    }
  }

  Distribution& all_;
  const Survey& frame_;
  const PackedFormat format_;
  const std::uint64_t limit_;
  const RunPlan plan_;
  const Workspace work_;
  const ConvertControl& control_;
  std::mutex mutex_;  ///< guards all_.sets and doneTasks_ while threads run
  std::map<std::pair<std::size_t, std::size_t>, std::pair<Split, std::size_t>> splits_;  ///< by set and cell
  std::deque<std::set<std::uint64_t>> doneTasks_{1};                                     ///< by set
};

}  // namespace

void splitAndMerge(Distribution& all, const Survey& frame, const PackedFormat& format, std::uint64_t limit,
                   const ConvertOptions& options, Workspace work, const ConvertControl& control) {
  Splitter splitter(all, frame, format, limit, planRuns(format, options), work, control);
  splitter.takeUpJournal();
  splitter.run();
  splitter.fillBuckets();
}

}  // namespace strata
