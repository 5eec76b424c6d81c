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

/// Hands out the stretches of one chunk after the other. Used by one thread at a time.
class ChunkWalk {
 public:
  ChunkWalk(const Distribution& all, const Journal& journal) : all_(all), journal_(journal) {
    for (const Chunk& chunk : all.chunks) ++left_[chunk.set];
  }
  std::vector<Stretch> next(const Chunk& chunk) {
    auto cursor = cursors_.find(chunk.set);
    if (cursor == cursors_.end()) cursor = cursors_.try_emplace(chunk.set, all_.sets[chunk.set], journal_).first;
    std::vector<Stretch> stretches = cursor->second.take(chunk.firstCell, chunk.endCell);
    if (--left_[chunk.set] == 0) cursors_.erase(cursor);
    return stretches;
  }

 private:
  const Distribution& all_;
  const Journal& journal_;
  std::map<std::size_t, std::size_t> left_;   ///< chunks that have not been handed out, by run set
  std::map<std::size_t, RunCursor> cursors_;  ///< by run set, of those that are in use
};

/// Gives the disk of finished stretches back. Chunks use up a run from front to back, so that stretches of a run are
/// collected and given back a good piece at a time. Used by one thread at a time.
class Releaser {
 public:
  explicit Releaser(Spill& spill) : spill_(spill) {}
  void add(const Stretch& stretch) {
    Finished& finished = finished_[stretch.run];
    if (stretch.offset != finished.end) {
      spill_.release(finished.begin, finished.end);
      finished.begin = stretch.offset;
    }
    finished.end = stretch.end();
    if (finished.end - finished.begin < kReleaseBytes) return;
    spill_.release(finished.begin, finished.end);
    finished.begin = finished.end / kPage * kPage;  // the last page is not given back yet
  }

 private:
  static constexpr std::uint64_t kPage = 4096;
  struct Finished {
    std::uint64_t begin = 0, end = 0;  ///< in the spill
  };
  Spill& spill_;
  std::map<const Run*, Finished> finished_;
};

/// The chunks as pieces of work.
class ChunkWork {
 public:
  struct Piece {
    std::vector<Stretch> stretches;
    BuiltChunk built;
  };

  ChunkWork(const Conversion& conversion, const BuildContext& context, const Distribution& all, NodeSink& sink)
      : conversion_(conversion),
        context_(context),
        all_(all),
        sink_(sink),
        walk_(all, conversion.journal),
        releaser_(conversion.spill) {}

  /// Takes the place of a chunk that an interrupted conversion has built.
  void skip(std::size_t index, ChunkTop&& top) {
    if (index >= all_.chunks.size() || all_.chunks[index].cell != top.key)
      throw Error(conversion_.journal.path(), "tells of chunks that there are not");
    for (const Stretch& stretch : walk_.next(all_.chunks[index])) releaser_.add(stretch);
    done_ += all_.chunks[index].points;
    tops_.push_back(std::move(top));
  }
  std::vector<ChunkTop> takeTops() { return std::move(tops_); }

  /// A sliced chunk is never in memory whole.
  std::uint64_t points(std::size_t index) const { return all_.chunks[index].sliced ? 0 : all_.chunks[index].points; }

  Piece begin(std::size_t index) {
    conversion_.control.checkStop();
    return {walk_.next(all_.chunks[index]), {}};
  }

  void build(std::size_t index, Piece& piece) {
    const Chunk& chunk = all_.chunks[index];
    if (chunk.sliced) return;  // its slices are written in their order, so finish() builds them
    std::vector<std::byte> points;
    points.reserve(chunk.points * context_.format.stride());
    readPoints(chunk, piece.stretches,
               [&](std::span<const std::byte> block) { points.insert(points.end(), block.begin(), block.end()); });
    std::unique_ptr<ChunkScratch> scratch = scratches_.lend();
    piece.built = buildChunk(context_, chunk.cell, std::move(points), *scratch);
    scratches_.giveBack(std::move(scratch));
  }

  void finish(std::size_t index, Piece& piece) {
    const Chunk& chunk = all_.chunks[index];
    if (chunk.sliced) {
      SliceBuilder slices(context_, chunk.cell, chunk.points);
      readPoints(chunk, piece.stretches, [&](std::span<const std::byte> block) { sink_.write(slices.add(block)); });
      piece.built = {{}, slices.takeTopPoints(), slices.takeTopChildren()};
    }
    ChunkRecord record;
    record.index = index;
    record.top = {chunk.cell, conversion_.spill.put(piece.built.topPoints), std::move(piece.built.topChildren)};
    sink_.write(std::move(piece.built.nodes));
    record.written = sink_.endChunk();
    appendChunk(conversion_.journal, record);
    // Only now that the journal has the chunk its points may go.
    for (const Stretch& stretch : piece.stretches) releaser_.add(stretch);
    tops_.push_back(std::move(record.top));
    conversion_.control.progress({stage::kBuild, done_ += chunk.points, context_.info.points});
  }

 private:
  /// Hands the points of a chunk to `see(packed points)`, a block at a time.
  template <typename See>
  void readPoints(const Chunk& chunk, const std::vector<Stretch>& stretches, See&& see) {
    const PackedFormat& format = context_.format;
    std::vector<std::byte> block(RunSorter::kBlockPoints * format.stride()), scratch;
    std::uint64_t points = 0;
    for (const Stretch& stretch : stretches) {
      StretchReader reader(conversion_.spill, all_.sets[chunk.set].grid, format, stretch);
      while (reader.left() > 0) {
        conversion_.control.checkStop();
        const std::size_t count = std::min<std::uint64_t>(reader.left(), RunSorter::kBlockPoints);
        reader.read(count, scratch, block.data());
        points += count;
        if (points > chunk.points)
          throw Error(conversion_.spill.path(), "holds more points of a cell than were counted");
        see(std::span<const std::byte>(block).first(count * format.stride()));
      }
    }
    if (points != chunk.points) throw Error(conversion_.spill.path(), "holds fewer points of a cell than were counted");
  }

  const Conversion& conversion_;
  const BuildContext& context_;
  const Distribution& all_;
  NodeSink& sink_;  ///< used by finish() alone
  ScratchPool scratches_;

  ChunkWalk walk_;  ///< used by begin() alone, once run() has begun

  // Used by finish() alone, once run() has begun.
  Releaser releaser_;
  std::vector<ChunkTop> tops_;
  std::uint64_t done_ = 0;  ///< points
};

}  // namespace

std::vector<ChunkTop> buildChunks(const Conversion& conversion, const BuildContext& context, const Distribution& all,
                                  std::vector<ChunkRecord> found, NodeSink& sink) {
  ChunkWork work(conversion, context, all, sink);
  for (std::size_t index = 0; index < found.size(); ++index) work.skip(index, std::move(found[index].top));
  InOrder<ChunkWork> chunks(work, found.size(), all.chunks.size(), context.pointsAtOnce);
  chunks.run(static_cast<std::size_t>(conversion.options.threads));
  return work.takeTops();
}

}  // namespace strata
