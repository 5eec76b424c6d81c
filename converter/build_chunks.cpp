#include "converter/build_chunks.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <utility>

#include "converter/chunk_builder.h"
#include "converter/run_sorter.h"
#include "converter/slices.h"
#include "core/error.h"

namespace strata {
namespace {

constexpr std::uint64_t kReleaseBytes = std::uint64_t{1} << 20;

/// Hands out the extents of one bucket after the other.
class BucketWalk {
 public:
  BucketWalk(const Distribution& all, const Journal& journal) : all_(all), journal_(journal) {
    for (const Bucket& bucket : all.buckets) ++left_[bucket.set];
  }
  std::vector<Extent> next(const Bucket& bucket) {
    auto cursor = cursors_.find(bucket.set);
    if (cursor == cursors_.end()) cursor = cursors_.try_emplace(bucket.set, all_.sets[bucket.set], journal_).first;
    std::vector<Extent> extents = cursor->second.take(bucket.firstCell, bucket.endCell);
    if (--left_[bucket.set] == 0) cursors_.erase(cursor);
    return extents;
  }

 private:
  const Distribution& all_;
  const Journal& journal_;
  std::map<std::size_t, std::size_t> left_;  ///< buckets by set
  std::map<std::size_t, RunCursor> cursors_;
};

/// Gives back what chunks no longer need of the runs, which they use up front to back, a good piece at a time.
class Releaser {
 public:
  explicit Releaser(Spill& spill) : spill_(spill) {}
  void add(const Extent& extent) {
    Piece& piece = pieces_[extent.run];
    const std::uint64_t end = extent.offset + extent.points * extent.run->shape.stride();
    if (extent.offset != piece.end) {
      spill_.release(piece.begin, piece.end);
      piece.begin = extent.offset;
    }
    piece.end = end;
    if (piece.end - piece.begin < kReleaseBytes) return;
    spill_.release(piece.begin, piece.end);
    piece.begin = piece.end / kPage * kPage;
  }

 private:
  static constexpr std::uint64_t kPage = 4096;
  struct Piece {
    std::uint64_t begin = 0, end = 0;
  };
  Spill& spill_;
  std::map<const Run*, Piece> pieces_;
};

struct Work {
  std::size_t index = 0;
  std::uint64_t points = 0;  ///< in memory
  std::vector<Extent> extents;
  BuiltChunk built;
};

/// Takes chunks up in order, builds them on several threads, and finishes them in order, one at a time. A thread goes
/// on while its chunk waits for an older one (chunks differ in size by a factor of ten and more), as long as all that
/// are neither finished nor waiting to be taken up have `pointsAtOnce` points together, or there is only one.
class InOrder {
 public:
  std::uint64_t pointsAtOnce;
  std::size_t next, end;                           ///< chunks to take up
  std::function<std::uint64_t(std::size_t)> size;  ///< Work::points of a chunk
  std::function<Work(std::size_t)> begin;          ///< one call at a time, in order
  std::function<void(Work&)> build;                ///< on all threads
  std::function<void(Work&)> finish;               ///< one call at a time, in order

  /// Throws what was thrown first.
  void run(int threads) {
    {
      std::vector<std::jthread> others;
      for (int i = 1; i < threads; ++i) others.emplace_back([this] { work(); });
      work();
    }
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    try {
      for (;;) {
        changed_.wait(lock, [&] { return over() || taken_ == 0 || taken_ + size(next) <= pointsAtOnce; });
        if (over()) return;
        Work chunk = begin(next);
        chunk.index = next++;
        chunk.points = size(chunk.index);
        taken_ += chunk.points;
        ++unfinished_;
        lock.unlock();
        build(chunk);
        lock.lock();
        built_.emplace(chunk.index, std::move(chunk));
        finishAll(lock);
      }
    } catch (...) {
      if (!lock.owns_lock()) lock.lock();
      if (!thrown_) thrown_ = std::current_exception();
      changed_.notify_all();
    }
  }
  void finishAll(std::unique_lock<std::mutex>& lock) {
    while (!finishing_ && !thrown_ && !built_.empty() && built_.begin()->first + unfinished_ == next) {
      Work chunk = std::move(built_.begin()->second);
      built_.erase(built_.begin());
      finishing_ = true;
      lock.unlock();
      finish(chunk);
      chunk.built = {};
      lock.lock();
      finishing_ = false;
      --unfinished_;
      taken_ -= chunk.points;
      changed_.notify_all();
    }
  }
  bool over() const { return thrown_ != nullptr || next == end; }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::size_t, Work> built_;  ///< by index; all of these guarded by mutex_, as is `next`
  std::uint64_t taken_ = 0;            ///< points of all that are not finished
  std::size_t unfinished_ = 0;
  bool finishing_ = false;
  std::exception_ptr thrown_;
};

/// Hands the points of a bucket to `see(packed bytes)`, a block at a time.
template <typename See>
void readPoints(const BuildFrame& frame, const Bucket& bucket, const CellGrid& grid, const std::vector<Extent>& extents,
                const Spill& spill, const ConvertControl& control, See&& see) {
  const std::size_t stride = frame.format.stride();
  std::vector<std::byte> block(RunSorter::kBlockPoints * stride), scratch;
  std::uint64_t points = 0;
  for (const Extent& extent : extents) {
    ExtentReader reader(spill, grid, frame.format, extent);
    while (reader.left() > 0) {
      control.checkStop();
      const std::size_t count = std::min<std::uint64_t>(reader.left(), RunSorter::kBlockPoints);
      reader.read(count, scratch, block.data());
      points += count;
      if (points > bucket.points) throw Error(spill.path(), "holds more points of a cell than were counted");
      see(std::span<const std::byte>(block).first(count * stride));
    }
  }
  if (points != bucket.points) throw Error(spill.path(), "holds fewer points of a cell than were counted");
}

}  // namespace

void appendChunk(Journal& journal, const ChunkRecord& chunk) {
  RecordWriter record;
  record.put(chunk.top.points);
  record.put(chunk.index);
  record.put(chunk.top.key);
  record.put(chunk.written.end);
  record.put(chunk.written.checksum);
  record.putAll(std::span(chunk.written.records));
  record.putAll(std::span(chunk.top.children));
  journal.append(RecordKind::chunk, record.bytes());
}

Spill::Handle readChunkTop(const Journal& journal, const Journal::Place& place) {
  const std::vector<std::byte> payload = journal.payload(place);
  return RecordReader(payload).get<Spill::Handle>();
}

std::vector<ChunkRecord> readChunks(const Journal& journal) {
  std::vector<ChunkRecord> chunks;
  for (const Journal::Place& place : journal.found()) {
    if (place.kind != RecordKind::chunk) continue;
    const std::vector<std::byte> payload = journal.payload(place);
    RecordReader record(payload);
    ChunkRecord chunk;
    chunk.top.points = record.get<Spill::Handle>();
    chunk.index = record.get<std::uint64_t>();
    chunk.top.key = record.get<NodeKey>();
    chunk.written.end = record.get<std::uint64_t>();
    chunk.written.checksum = record.get<std::uint64_t>();
    chunk.written.records = record.getAll<NodeRecord>();
    chunk.top.children = record.getAll<SubtreeShape>();
    if (chunk.index < chunks.size()) chunks.resize(chunk.index);  // built again after some were found damaged
    if (chunk.index != chunks.size()) throw Error(journal.path(), "skips a chunk");
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

std::vector<ChunkTop> buildChunks(const BuildFrame& frame, const Distribution& all, std::vector<ChunkRecord> found,
                                  std::uint64_t pointsAtOnce, const ConvertOptions& options, Workspace work,
                                  NodeSink& sink, const ConvertControl& control) {
  std::vector<ChunkTop> tops;
  std::uint64_t done = 0;
  BucketWalk walk(all, work.journal);
  Releaser releaser(work.spill);
  ScratchPool scratches;
  std::size_t next = 0;
  for (; next < found.size(); ++next) {
    if (next >= all.buckets.size() || all.buckets[next].cell != found[next].top.key)
      throw Error(work.journal.path(), "tells of chunks that there are not");
    for (const Extent& extent : walk.next(all.buckets[next])) releaser.add(extent);
    done += all.buckets[next].points;
    tops.push_back(std::move(found[next].top));
  }
  InOrder chunks;
  chunks.pointsAtOnce = pointsAtOnce;
  chunks.next = next;
  chunks.end = all.buckets.size();
  chunks.size = [&](std::size_t index) { return all.buckets[index].sliced ? 0 : all.buckets[index].points; };
  chunks.begin = [&](std::size_t index) {
    control.checkStop();
    Work chunk;
    chunk.extents = walk.next(all.buckets[index]);
    return chunk;
  };
  const auto read = [&](const Work& chunk, auto&& see) {
    const Bucket& bucket = all.buckets[chunk.index];
    readPoints(frame, bucket, all.sets[bucket.set].grid, chunk.extents, work.spill, control, see);
  };
  chunks.build = [&](Work& chunk) {
    const Bucket& bucket = all.buckets[chunk.index];
    if (bucket.sliced) return;  // too large for one piece, and for any order but its own
    std::vector<std::byte> points;
    points.reserve(bucket.points * frame.format.stride());
    read(chunk, [&](std::span<const std::byte> block) { points.insert(points.end(), block.begin(), block.end()); });
    std::unique_ptr<ChunkScratch> scratch = scratches.lend();
    chunk.built = buildChunk(frame, bucket.cell, std::move(points), *scratch);
    scratches.giveBack(std::move(scratch));
  };
  chunks.finish = [&](Work& chunk) {
    const Bucket& bucket = all.buckets[chunk.index];
    ChunkRecord record;
    record.index = chunk.index;
    if (bucket.sliced) {
      SliceBuilder slices(frame, bucket.cell, bucket.points);
      read(chunk, [&](std::span<const std::byte> block) { sink.write(slices.add(block)); });
      chunk.built = {{}, slices.takeTopPoints(), slices.takeTopChildren()};
    }
    record.top = {bucket.cell, work.spill.put(chunk.built.topPoints), std::move(chunk.built.topChildren)};
    sink.write(std::move(chunk.built.nodes));
    record.written = sink.endChunk();
    appendChunk(work.journal, record);
    for (const Extent& extent : chunk.extents) releaser.add(extent);
    tops.push_back(std::move(record.top));
    control.progress({stage::kBuild, done += bucket.points, frame.info.points});
  };
  chunks.run(static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(options.threads), chunks.end - next + 1)));
  return tops;
}

}  // namespace strata
