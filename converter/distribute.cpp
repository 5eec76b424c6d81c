#include "converter/distribute.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_for_each.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <iomanip>
#include <limits>
#include <mutex>
#include <sstream>

#include "core/error.h"
#include "core/morton.h"

namespace strata {
namespace {

constexpr int kMostFirstLevel = 5;  // 8^5 cells at most in the first pass
constexpr int kSplitLevels = 2;     // a cell too large becomes up to 64
constexpr std::size_t kLeastSlab = 65536;
constexpr std::size_t kMostSlab = 1 << 20;
/// A cell of the deepest level cannot be split; this many bucket limits still fit the memory cap.
constexpr std::uint64_t kDeepestCellLimits = 3;

/// Cells of one level below a cell, addressed by their Morton index inside it.
struct CellGrid {
  NodeKey parent;
  int levels = 0;  ///< below the parent
  int shift = 0;   ///< of a grid integer to get the cell at that level
  std::uint64_t mask = 0;

  CellGrid(NodeKey parentCell, int levelsBelow, int cubeBits)
      : parent(parentCell),
        levels(levelsBelow),
        shift(cubeBits - parentCell.level() - levelsBelow),
        mask((std::uint64_t{1} << (3 * levelsBelow)) - 1) {}

  std::uint32_t index(const std::int64_t (&grid)[3]) const {
    return static_cast<std::uint32_t>(mortonCode(static_cast<std::uint64_t>(grid[0] >> shift),
                                                 static_cast<std::uint64_t>(grid[1] >> shift),
                                                 static_cast<std::uint64_t>(grid[2] >> shift)) &
                                      mask);
  }
  NodeKey cell(std::uint32_t cellIndex) const { return {parent.code << (3 * levels) | cellIndex}; }
};

/// Buckets that several threads fill.
class BucketSet {
 public:
  BucketSet(const CellGrid& grid, const PackedFormat& format, Spill& spill)
      : grid_(grid), format_(format), spill_(spill), buckets_(std::size_t{1} << (3 * grid.levels)) {}

  /// Sorts a slab of packed points by cell (counting sort: order inside a cell stays) and puts each cell's run away.
  void add(const std::vector<std::byte>& points, std::uint64_t sequence) {
    const std::size_t stride = format_.stride();
    const std::size_t count = points.size() / stride;
    std::vector<std::uint32_t> cells(count);
    std::vector<std::uint32_t> starts(buckets_.size() + 1);
    for (std::size_t i = 0; i < count; ++i) {
      std::int64_t grid[3];
      format_.getPosition(points.data() + i * stride, grid);
      cells[i] = grid_.index(grid);
      ++starts[cells[i] + 1];
    }
    for (std::size_t c = 1; c < starts.size(); ++c) starts[c] += starts[c - 1];
    std::vector<std::byte> sorted(points.size());
    std::vector<std::uint32_t> next(starts.begin(), starts.end() - 1);
    for (std::size_t i = 0; i < count; ++i)
      std::memcpy(sorted.data() + next[cells[i]]++ * stride, points.data() + i * stride, stride);
    for (std::size_t c = 0; c < buckets_.size(); ++c) {
      if (starts[c] == starts[c + 1]) continue;
      Spill::Handle handle =
          spill_.put(std::span(sorted).subspan(starts[c] * stride, (starts[c + 1] - starts[c]) * stride));
      const std::lock_guard lock(mutex_);
      buckets_[c].points += starts[c + 1] - starts[c];
      buckets_[c].blocks.push_back({sequence, std::move(handle)});
    }
  }

  std::vector<Bucket> take() {
    std::vector<Bucket> taken;
    for (std::uint32_t c = 0; c < buckets_.size(); ++c) {
      if (buckets_[c].points == 0) continue;
      buckets_[c].cell = grid_.cell(c);
      std::sort(buckets_[c].blocks.begin(), buckets_[c].blocks.end(),
                [](const Bucket::Block& a, const Bucket::Block& b) { return a.sequence < b.sequence; });
      taken.push_back(std::move(buckets_[c]));
    }
    return taken;
  }

 private:
  const CellGrid grid_;
  const PackedFormat format_;
  Spill& spill_;
  std::mutex mutex_;
  std::vector<Bucket> buckets_;  ///< by cell index; guarded by mutex_
};

/// What one thread has seen.
struct ThreadTally {
  explicit ThreadTally(const PointLayout& layout) : stats(layout) {}
  AttributeStats stats;
  std::int64_t low[3] = {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::max(),
                         std::numeric_limits<std::int64_t>::max()};
  std::int64_t high[3] = {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::min(),
                          std::numeric_limits<std::int64_t>::min()};
};

/// Turns reader blocks into packed points on the store's grid.
class Packer {
 public:
  Packer(const Survey& frame, const PackedFormat& format)
      : frame_(frame), format_(format), end_(std::ldexp(1.0, frame.cubeBits)) {}

  /// Returns the number of points left out because they are not finite; `outside` is set when one is off the cube.
  std::uint64_t pack(const PointBlock& block, const SourceInfo& info, const SourceMapping& mapping,
                     std::vector<std::byte>& out, ThreadTally& tally, bool& outside) const {
    const std::size_t sourceStride = info.layout.stride();
    const std::size_t stride = format_.stride();
    const glm::dvec3 perStep = 1.0 / frame_.grid.scale;
    out.resize(block.count() * stride);
    std::byte* record = out.data();
    for (std::size_t i = 0; i < block.count(); ++i) {
      const glm::dvec3 steps = (block.positions[i] + mapping.originDelta) * perStep;
      std::int64_t grid[3];
      if (!toGrid(steps, grid)) {
        if (std::isfinite(steps.x + steps.y + steps.z)) outside = true;
        continue;
      }
      format_.putPosition(record, grid);
      for (int axis = 0; axis < 3; ++axis) {
        tally.low[axis] = std::min(tally.low[axis], grid[axis]);
        tally.high[axis] = std::max(tally.high[axis], grid[axis]);
      }
      copyRecord(block.attributes.data() + i * sourceStride, mapping, record + format_.positionBytes());
      record += stride;
    }
    const auto kept = static_cast<std::size_t>(record - out.data()) / stride;
    out.resize(kept * stride);
    tally.stats.gather(out.data() + format_.positionBytes(), stride, kept);
    return block.count() - kept;
  }

 private:
  bool toGrid(const glm::dvec3& steps, std::int64_t (&grid)[3]) const {
    for (int axis = 0; axis < 3; ++axis) {
      const double rounded = std::floor(steps[axis] + 0.5);
      if (!(rounded >= 0.0 && rounded < end_)) return false;
      grid[axis] = static_cast<std::int64_t>(rounded);
    }
    return true;
  }
  void copyRecord(const std::byte* from, const SourceMapping& mapping, std::byte* to) const {
    if (mapping.sameLayout) {
      std::copy_n(from, format_.attributeBytes, to);
      return;
    }
    std::memset(to, 0, format_.attributeBytes);
    for (const SourceMapping::Column& c : mapping.columns) std::memcpy(to + c.to, from + c.from, c.bytes);
    if (mapping.colourShiftAt >= 0) to[mapping.colourShiftAt] = static_cast<std::byte>(mapping.colourShift);
  }

  const Survey& frame_;
  const PackedFormat format_;
  const double end_;
};

int firstLevel(std::uint64_t points, std::uint64_t limit, int cubeBits) {
  if (points <= limit) return 0;
  const double ratio = static_cast<double>(points) / static_cast<double>(limit);
  return std::min({static_cast<int>(std::ceil(std::log2(ratio) * 0.5)) + 2, kMostFirstLevel, cubeBits});
}

/// A point of a slab lives about three times at once: as read, packed, sorted.
std::size_t slabPointBytes(const PointLayout& layout) { return 3 * (layout.stride() + sizeof(glm::dvec3)); }

/// Threads whose slabs fit into a quarter of the memory.
int slabsAtOnce(const ConvertOptions& options, std::size_t slabBytes) {
  return static_cast<int>(
      std::clamp<std::uint64_t>(options.memoryBytes / 4 / slabBytes, 1, static_cast<std::uint64_t>(options.threads)));
}

/// Reads everything once.
void readSources(const std::vector<std::unique_ptr<PointSource>>& sources, const Survey& frame, const Packer& packer,
                 std::size_t slabPoints, BucketSet& buckets, const ConvertOptions& options,
                 const ConvertControl& control, Distribution& out) {
  struct Part {
    std::size_t source, part;
  };
  std::vector<Part> parts;
  for (std::size_t s = 0; s < sources.size(); ++s)
    for (std::size_t p = 0; p < sources[s]->partCount(); ++p) parts.push_back({s, p});
  std::vector<std::atomic<std::uint64_t>> kept(sources.size()), skipped(sources.size());
  std::atomic<std::uint64_t> done{0};
  std::atomic<bool> outside{false}, failed{false};
  std::atomic<std::size_t> nextPart{0};
  tbb::enumerable_thread_specific<ThreadTally> tallies([&] { return ThreadTally(frame.layout); });

  const auto readPart = [&](std::size_t index) {
    const Part& part = parts[index];
    const SourceInfo& info = sources[part.source]->info();
    const auto reader = sources[part.source]->openPart(part.part);
    PointBlock block;
    std::vector<std::byte> packed;
    for (std::uint64_t slab = 0; !outside && !failed && reader->read(block, slabPoints); ++slab) {
      control.checkStop();
      bool offCube = false;
      const std::uint64_t left =
          packer.pack(block, info, frame.mappings[part.source], packed, tallies.local(), offCube);
      if (offCube) outside = true;
      skipped[part.source] += left;
      kept[part.source] += block.count() - left;
      buckets.add(packed, static_cast<std::uint64_t>(index) << 24 | slab);
      control.progress({stage::kDistribute, done += block.count(), frame.claimedPoints});
    }
  };
  // Parts are taken in order, so that one slow file at the end does not wait behind a single thread.
  const int workers = slabsAtOnce(options, slabPoints * slabPointBytes(frame.layout));
  tbb::task_arena arena(workers);
  arena.execute([&] {
    tbb::parallel_for(0, workers, [&](int) {
      for (std::size_t index = nextPart++; !failed && index < parts.size(); index = nextPart++) {
        try {
          readPart(index);
        } catch (...) {
          failed = true;  // the others need not read on
          throw;
        }
      }
    });
  });

  ThreadTally total(frame.layout);
  for (const ThreadTally& t : tallies) {
    total.stats.add(t.stats);
    for (int axis = 0; axis < 3; ++axis) {
      total.low[axis] = std::min(total.low[axis], t.low[axis]);
      total.high[axis] = std::max(total.high[axis], t.high[axis]);
    }
  }
  out.outsideCube = outside;
  out.ranges = total.stats.ranges();
  for (std::size_t s = 0; s < sources.size(); ++s) {
    out.sourcePoints.push_back(kept[s]);
    out.sourceSkipped.push_back(skipped[s]);
    out.points += kept[s];
  }
  if (out.points > 0)
    for (int axis = 0; axis < 3; ++axis) {
      out.bounds.min[axis] = static_cast<double>(total.low[axis]);
      out.bounds.max[axis] = static_cast<double>(total.high[axis]);
    }
}

/// Splits a bucket until each part is small enough; appends the parts in Morton order.
void splitBucket(Bucket bucket, const PackedFormat& format, const Box& rootCube, int cubeBits, std::uint64_t limit,
                 std::size_t slabPoints, Spill& spill, const ConvertControl& control, std::vector<Bucket>& out) {
  const int room = std::min(NodeKey::kDeepestLevel, cubeBits) - bucket.cell.level();
  if (bucket.points <= limit || room <= 0) {
    if (bucket.points > kDeepestCellLimits * limit) {
      const Box cell = nodeCube(bucket.cell, rootCube);
      std::ostringstream place;
      place << std::setprecision(10) << "around " << cell.centre().x << " " << cell.centre().y << " "
            << cell.centre().z;
      throw Error(place.str(), "more points lie in a cell of " + std::to_string(cell.size().x) +
                                   " m, the smallest there is, than --memory can hold, found " +
                                   std::to_string(bucket.points) + " (expected at most " +
                                   std::to_string(kDeepestCellLimits * limit) + ")");
    }
    out.push_back(std::move(bucket));
    return;
  }
  BucketSet parts(CellGrid(bucket.cell, std::min(kSplitLevels, room), cubeBits), format, spill);
  std::vector<std::byte> slab;
  std::uint64_t sequence = 0;
  for (std::size_t b = 0; b < bucket.blocks.size(); ++b) {
    spill.take(bucket.blocks[b].handle, slab);
    if (slab.size() < slabPoints * format.stride() && b + 1 < bucket.blocks.size()) continue;
    control.checkStop();
    parts.add(slab, sequence++);
    slab.clear();
  }
  for (Bucket& part : parts.take())
    splitBucket(std::move(part), format, rootCube, cubeBits, limit, slabPoints, spill, control, out);
}

/// The largest cells whose points stay within the limit, from the top down. `first` to `last` lie inside `cell`.
void mergeBuckets(NodeKey cell, std::vector<Bucket>::iterator first, std::vector<Bucket>::iterator last,
                  std::uint64_t limit, std::vector<Bucket>& out) {
  if (first == last) return;
  std::uint64_t points = 0;
  for (auto b = first; b != last; ++b) points += b->points;
  if (first + 1 == last && (first->cell == cell || points > limit)) {
    out.push_back(std::move(*first));
    return;
  }
  if (points <= limit) {
    Bucket merged;
    merged.cell = cell;
    merged.points = points;
    for (auto b = first; b != last; ++b)
      std::move(b->blocks.begin(), b->blocks.end(), std::back_inserter(merged.blocks));
    out.push_back(std::move(merged));
    return;
  }
  for (int octant = 0; octant < 8; ++octant) {
    const NodeKey child = cell.child(octant);
    const auto end = std::find_if(first, last, [&](const Bucket& b) { return !child.isAncestorOf(b.cell); });
    mergeBuckets(child, first, end, limit, out);
    first = end;
  }
}

}  // namespace

Distribution distribute(const std::vector<std::unique_ptr<PointSource>>& sources, const Survey& frame,
                        const PackedFormat& format, std::uint64_t bucketLimit, const ConvertOptions& options,
                        Spill& spill, const ConvertControl& control) {
  Distribution out;
  const std::size_t slabBytes = options.memoryBytes / 16 / static_cast<std::size_t>(options.threads);
  const std::size_t slabPoints = std::clamp(slabBytes / slabPointBytes(frame.layout), kLeastSlab, kMostSlab);
  const CellGrid grid(NodeKey{}, firstLevel(frame.claimedPoints, bucketLimit, frame.cubeBits), frame.cubeBits);
  BucketSet buckets(grid, format, spill);
  readSources(sources, frame, Packer(frame, format), slabPoints, buckets, options, control, out);
  if (out.outsideCube) return out;

  std::vector<Bucket> coarse = buckets.take();
  std::vector<std::vector<Bucket>> parts(coarse.size());
  const Box rootCube{frame.grid.offset, frame.grid.offset + frame.grid.scale * std::ldexp(1.0, frame.cubeBits)};
  tbb::task_arena arena(slabsAtOnce(options, slabPoints * slabPointBytes(frame.layout)));
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, coarse.size(), [&](std::size_t i) {
      splitBucket(std::move(coarse[i]), format, rootCube, frame.cubeBits, bucketLimit, slabPoints, spill, control,
                  parts[i]);
    });
  });
  std::vector<Bucket> fine;
  for (std::vector<Bucket>& p : parts) std::move(p.begin(), p.end(), std::back_inserter(fine));
  mergeBuckets(NodeKey{}, fine.begin(), fine.end(), bucketLimit, out.buckets);
  return out;
}

}  // namespace strata
