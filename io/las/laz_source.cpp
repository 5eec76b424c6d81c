#include "io/las/laz_source.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/log.h"
#include "io/las/las_record.h"
#include "io/las/laz_codec.h"
#include "io/las/laz_header.h"

namespace strata {
namespace {

constexpr std::uint64_t kPartPoints = std::uint64_t{1} << 19;
constexpr std::size_t kBatchPoints = 4096;       // decoded before they are unpacked
constexpr std::uint64_t kPointsPerByte = 10000;  // more than any cloud compresses to

struct LazPart {
  std::vector<LazRun> runs;
  std::uint64_t firstPoint = 0;  ///< number in the file, for messages
};

/// A file's heads, and its chunks as parts.
struct LazContents {
  LasHeader header;
  LazFormat format;
  std::vector<LazPart> parts;
};

/// Compressed records. Every reader has a decoder of its own, so parts are decoded side by side.
class LazSource final : public PointSource {
 public:
  LazSource(std::unique_ptr<ByteSource> file, LazContents contents, SourceInfo info, bool skipDamaged)
      : file_(std::move(file)), contents_(std::move(contents)), info_(std::move(info)), skipDamaged_(skipDamaged) {}

  const SourceInfo& info() const override { return info_; }
  std::size_t partCount() const override { return contents_.parts.size(); }
  std::unique_ptr<PointReader> openPart(std::size_t part) const override { return open(part, false); }
  std::unique_ptr<PointReader> openIntegers(std::size_t part) const override { return open(part, true); }

  std::unique_ptr<LazDecoder> openRun(const LazRun& run) const {
    return std::make_unique<LazDecoder>(*file_, contents_.header, contents_.format, run);
  }
  const LasHeader& header() const { return contents_.header; }
  bool skipDamaged() const { return skipDamaged_; }

 private:
  std::unique_ptr<PointReader> open(std::size_t part, bool integers) const;

  std::unique_ptr<ByteSource> file_;
  LazContents contents_;
  SourceInfo info_;
  bool skipDamaged_;
};

class LazReader final : public PointReader {
 public:
  LazReader(const LazSource& source, const LazPart& part, bool integers)
      : source_(source),
        part_(part),
        integers_(integers),
        record_{source.header().pointFormat, source.header().recordBytes},
        nextPoint_(part.firstPoint),
        batch_(kBatchPoints * record_.recordBytes) {}

  bool read(PointBlock& block, std::size_t maxPoints) override {
    if (integers_)
      return readInto(block, maxPoints, block.integers, [&](std::span<glm::ivec3> integers, std::byte* attributes) {
        unpackLasRecords(record_, batch_.data(), integers, attributes);
      });
    return readInto(block, maxPoints, block.positions, [&](std::span<glm::dvec3> positions, std::byte* attributes) {
      unpackLasRecords(record_, source_.header().scale, batch_.data(), positions, attributes);
    });
  }

 private:
  template <typename Position, typename Unpack>
  bool readInto(PointBlock& block, std::size_t maxPoints, std::vector<Position>& positions, Unpack unpack) {
    if (failure_ && !source_.skipDamaged()) throw *failure_;
    const std::size_t stride = lasStride(record_);
    positions.resize(maxPoints);
    block.attributes.resize(maxPoints * stride);
    std::size_t done = 0;
    while (done < maxPoints && !failure_) {
      const std::size_t points = decode(std::min(kBatchPoints, maxPoints - done));
      if (points == 0) break;
      unpack(std::span(positions).subspan(done, points), block.attributes.data() + done * stride);
      done += points;
    }
    positions.resize(done);
    block.attributes.resize(done * stride);
    if (done == 0 && failure_ && !source_.skipDamaged()) throw *failure_;
    return done != 0;
  }

  /// Fills the batch with at most `wanted` records and returns their number, which is less at the end of a run or at
  /// damage.
  std::size_t decode(std::size_t wanted) {
    try {
      if (!decoder_ || decoder_->left() == 0) {
        if (run_ == part_.runs.size()) return 0;
        decoder_ = source_.openRun(part_.runs[run_]);
        runStart_ = nextPoint_;
        ++run_;
      }
      wanted = static_cast<std::size_t>(std::min<std::uint64_t>(wanted, decoder_->left()));
      std::size_t done = 0;
      while (done < wanted) {
        failure_ = decoder_->next(runStart_, batch_.data() + done * record_.recordBytes);
        if (failure_) break;
        ++done;
      }
      nextPoint_ += done;
      return done;
    } catch (const Error& error) {
      failure_ = error;
      return 0;
    }
  }

  const LazSource& source_;
  const LazPart& part_;
  const bool integers_;
  LasRecordFormat record_;
  std::size_t run_ = 0;  ///< index of the next run
  std::uint64_t runStart_ = 0;
  std::uint64_t nextPoint_;
  std::unique_ptr<LazDecoder> decoder_;
  std::vector<std::byte> batch_;
  std::optional<Error> failure_;  ///< thrown after the points before it were handed out
};

std::unique_ptr<PointReader> LazSource::open(std::size_t part, bool integers) const {
  return std::make_unique<LazReader>(*this, contents_.parts[part], integers);
}

/// Cuts the chunks that hold the first `points` points into parts of about kPartPoints.
std::vector<LazPart> partsOf(const std::vector<LazChunk>& chunks, bool equalChunks, std::uint64_t points) {
  std::vector<LazPart> parts;
  std::uint64_t inPart = kPartPoints, before = 0;
  for (const LazChunk& chunk : chunks) {
    const std::uint64_t taken = std::min(chunk.points, points - before);
    if (taken == 0) continue;
    if (inPart >= kPartPoints) {
      parts.push_back({{}, before});
      inPart = 0;
    }
    std::vector<LazRun>& runs = parts.back().runs;
    if (runs.empty() || !equalChunks) runs.push_back({{}, chunk.offset, chunk.offset, chunk.points, 0});
    LazRun& run = runs.back();
    run.end = chunk.offset + chunk.bytes;
    run.chunkEnds.push_back(run.end);
    run.points += taken;
    inPart += taken;
    before += taken;
  }
  return parts;
}

/// All points as one part, for files without a chunk table.
std::vector<LazPart> onePart(const ByteSource& file, std::uint64_t begin, std::uint64_t chunkPoints,
                             std::uint64_t points) {
  const std::uint64_t bytes = file.size() - begin;
  if (points / kPointsPerByte > bytes)
    throw Error(file.name(), "more points than the file can hold, found " + std::to_string(bytes) +
                                 " bytes of points (expected " + std::to_string(points) + " points)");
  return {LazPart{{LazRun{{}, begin, file.size(), chunkPoints, points}}, 0}};
}

/// The chunk table. Empty when there is none, or when it is damaged and the user accepts that.
std::vector<LazChunk> findChunks(const ByteSource& file, const LasHeader& header, const LazFormat& format,
                                 bool skipDamaged) {
  try {
    const std::uint64_t table = chunkTableOffset(file, header);
    if (table != 0) return readChunkTable(file, header, format, table);
  } catch (const Error&) {
    if (!skipDamaged) throw;
  }
  return {};
}

}  // namespace

std::unique_ptr<PointSource> openLaz(std::unique_ptr<ByteSource> file, const LasHead& head, SourceInfo info,
                                     const SourceOptions& options) {
  const LasHeader& header = head.header;
  LazFormat format = parseLazFormat(info.path, head);
  std::vector<LazPart> parts;
  std::uint64_t points = info.pointCount;
  if (points != 0 && format.compressor == LazFormat::kPointwise) {
    parts = onePart(*file, header.pointsOffset, 0, points);
  } else if (points != 0) {
    const bool equalChunks = format.chunkSize != LazFormat::kVariableChunks;
    const std::vector<LazChunk> chunks = findChunks(*file, header, format, options.skipDamaged);
    std::uint64_t held = 0;
    for (const LazChunk& chunk : chunks) held += chunk.points;
    if (!chunks.empty()) {
      if (points > held && header.legacyPointCount != 0 && header.legacyPointCount <= held)
        points = info.pointCount = header.legacyPointCount;
      if (points > held && !options.skipDamaged)
        throw Error(info.path, "the file ends early, found chunks of " + std::to_string(held) + " points (expected " +
                                   std::to_string(points) + ")");
      points = std::min(points, held);
      std::uint64_t before = 0, more = 0;  // points of whole chunks behind those that the header counts
      for (const LazChunk& chunk : chunks) {
        if (before >= points) more += chunk.points;
        before += chunk.points;
      }
      if (more > 0)
        logWarning(info.path + ": the header counts " + std::to_string(points) + " points, found room for " +
                   std::to_string(more) + " more behind them, which are not read");
      parts = partsOf(chunks, equalChunks, points);
    } else if (equalChunks && file->size() - header.pointsOffset > 8) {
      parts = onePart(*file, std::uint64_t{header.pointsOffset} + 8, format.chunkSize, points);
    } else if (!options.skipDamaged) {
      throw Error(info.path, "chunks of varying size need a chunk table, found none (expected one)");
    }
  }
  info.uncompressedBytes = points * header.recordBytes;
  return std::make_unique<LazSource>(std::move(file), LazContents{header, std::move(format), std::move(parts)},
                                     std::move(info), options.skipDamaged);
}

}  // namespace strata
