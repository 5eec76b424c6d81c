#include "converter/build/build_chunks.h"

#include <algorithm>
#include <map>
#include <memory>
#include <span>
#include <utility>

#include "converter/build/chunk_builder.h"
#include "converter/build/in_order.h"
#include "converter/build/slices.h"
#include "converter/distribute/run_sorter.h"
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
  std::vector<Extent> extents;
  BuiltChunk built;
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
  InOrder<Work> chunks;
  chunks.pointsAtOnce = pointsAtOnce;
  chunks.next = next;
  chunks.end = all.buckets.size();
  chunks.size = [&](std::size_t index) { return all.buckets[index].sliced ? 0 : all.buckets[index].points; };
  chunks.begin = [&](std::size_t index) {
    control.checkStop();
    return Work{walk.next(all.buckets[index]), {}};
  };
  const auto read = [&](const Bucket& bucket, const Work& chunk, auto&& see) {
    readPoints(frame, bucket, all.sets[bucket.set].grid, chunk.extents, work.spill, control, see);
  };
  chunks.build = [&](std::size_t index, Work& chunk) {
    const Bucket& bucket = all.buckets[index];
    if (bucket.sliced) return;  // too large for one piece, and for any order but its own
    std::vector<std::byte> points;
    points.reserve(bucket.points * frame.format.stride());
    read(bucket, chunk,
         [&](std::span<const std::byte> block) { points.insert(points.end(), block.begin(), block.end()); });
    std::unique_ptr<ChunkScratch> scratch = scratches.lend();
    chunk.built = buildChunk(frame, bucket.cell, std::move(points), *scratch);
    scratches.giveBack(std::move(scratch));
  };
  chunks.finish = [&](std::size_t index, Work& chunk) {
    const Bucket& bucket = all.buckets[index];
    ChunkRecord record;
    record.index = index;
    if (bucket.sliced) {
      SliceBuilder slices(frame, bucket.cell, bucket.points);
      read(bucket, chunk, [&](std::span<const std::byte> block) { sink.write(slices.add(block)); });
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
  chunks.run(static_cast<std::size_t>(options.threads));
  return tops;
}

}  // namespace strata
