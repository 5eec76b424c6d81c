#include "converter/journal/records.h"

#include <span>
#include <utility>

#include "converter/journal/record_bytes.h"
#include "core/error.h"

namespace strata {
namespace {

/// The histogram becomes pairs of (values without points before it, points), ended by a pair with no points.
void putHistogram(RecordWriter& bytes, const std::vector<std::uint64_t>& histogram) {
  bytes.put<std::uint64_t>(histogram.size());
  std::uint64_t without = 0;
  for (const std::uint64_t points : histogram) {
    if (points == 0) {
      ++without;
      continue;
    }
    bytes.putShort(without);
    bytes.putShort(points);
    without = 0;
  }
  bytes.putShort(0);
  bytes.putShort(0);
}

std::vector<std::uint64_t> getHistogram(RecordReader& bytes) {
  constexpr std::uint64_t kMostValues = 65536;
  const auto size = bytes.get<std::uint64_t>();
  if (size > kMostValues) throw Error("a histogram of the journal is too long");
  std::vector<std::uint64_t> histogram(size);
  for (std::size_t value = 0;; ++value) {
    value += bytes.getShort();
    const std::uint64_t points = bytes.getShort();
    if (points == 0) return histogram;
    if (value >= histogram.size()) throw Error("a histogram of the journal is too long");
    histogram[value] = points;
  }
}

void putCounts(RecordWriter& bytes, const PointCounts& counts) {
  bytes.put(counts.low);
  bytes.put(counts.high);
  bytes.putAll(std::span(counts.sources));
  bytes.put(counts.attributes.points);
  bytes.putAll(std::span(counts.attributes.ranges));
  putHistogram(bytes, counts.attributes.intensities);
}

PointCounts getCounts(RecordReader& bytes) {
  PointCounts counts;
  counts.low = bytes.get<std::array<std::uint64_t, 3>>();
  counts.high = bytes.get<std::array<std::uint64_t, 3>>();
  counts.sources = bytes.getAll<SourceCount>();
  counts.attributes.points = bytes.get<std::uint64_t>();
  counts.attributes.ranges = bytes.getAll<ValueRange>();
  counts.attributes.intensities = getHistogram(bytes);
  return counts;
}

}  // namespace

void appendHead(Journal& journal, const JournalHead& head) {
  RecordWriter bytes;
  bytes.putText(head.spillPath);
  bytes.put<std::uint64_t>(head.terms.options.size());
  for (const auto& [name, value] : head.terms.options) {
    bytes.putText(name);
    bytes.putText(value);
  }
  bytes.put<std::uint64_t>(head.terms.inputs.size());
  for (const ConversionTerms::Input& input : head.terms.inputs) {
    bytes.putText(input.path);
    bytes.put(input.bytes);
    bytes.put(input.changedNs);
  }
  journal.append(RecordKind::options, bytes.bytes());
}

JournalHead readHead(const Journal& journal) {
  if (journal.found().empty() || journal.found().front().kind != RecordKind::options)
    throw Error(journal.path(), "does not say what was converted; --force starts the conversion again");
  const std::vector<std::byte> payload = journal.payload(journal.found().front());
  RecordReader bytes(payload);
  JournalHead head;
  head.spillPath = bytes.getText();
  head.terms.options.resize(bytes.get<std::uint64_t>());
  for (auto& [name, value] : head.terms.options) {
    name = bytes.getText();
    value = bytes.getText();
  }
  head.terms.inputs.resize(bytes.get<std::uint64_t>());
  for (ConversionTerms::Input& input : head.terms.inputs) {
    input.path = bytes.getText();
    input.bytes = bytes.get<std::uint64_t>();
    input.changedNs = bytes.get<std::int64_t>();
  }
  return head;
}

void appendMeasured(Journal& journal, const MeasuredExtents& measured) {
  RecordWriter bytes;
  bytes.put(measured.all);
  bytes.put<std::uint64_t>(measured.sources.size());
  for (const std::optional<MeasuredExtent>& extent : measured.sources) {
    bytes.put(extent.has_value());
    bytes.put(extent.value_or(MeasuredExtent{}));
  }
  journal.append(RecordKind::measured, bytes.bytes());
}

std::optional<MeasuredExtents> readMeasured(const Journal& journal) {
  for (const Journal::FoundRecord& found : journal.found()) {
    if (found.kind != RecordKind::measured) continue;
    const std::vector<std::byte> payload = journal.payload(found);
    RecordReader bytes(payload);
    MeasuredExtents measured;
    measured.all = bytes.get<bool>();
    const auto count = bytes.get<std::uint64_t>();
    for (std::uint64_t i = 0; i < count; ++i) {
      const bool has = bytes.get<bool>();
      const auto extent = bytes.get<MeasuredExtent>();
      measured.sources.push_back(has ? std::optional(extent) : std::nullopt);
    }
    return measured;
  }
  return std::nullopt;
}

void appendRuns(Journal& journal, RunsRecord& record) {
  RecordWriter bytes;
  bytes.put(record.set);
  bytes.put(record.task);
  bytes.put(record.counts.has_value());
  if (record.counts) putCounts(bytes, *record.counts);
  bytes.put<std::uint64_t>(record.runs.size());
  std::vector<std::size_t> cellsAt;  // offsets in the payload
  for (const WrittenRun& written : record.runs) {
    bytes.put(written.run.sequence);
    bytes.put(written.run.offset);
    bytes.put(written.run.points);
    bytes.put(written.run.shape.axisBytes);
    bytes.putAll(std::span(written.run.shape.constants));
    bytes.putAll(std::span(written.run.shape.kept));
    cellsAt.push_back(bytes.size() + sizeof(std::uint64_t));  // behind their number
    bytes.putAll(std::span(written.cells));
  }
  const std::uint64_t payloadAt = journal.append(RecordKind::runs, bytes.bytes());
  for (std::size_t i = 0; i < record.runs.size(); ++i) {
    record.runs[i].run.cellsAt = payloadAt + cellsAt[i];
    record.runs[i].run.cells = static_cast<std::uint32_t>(record.runs[i].cells.size());
  }
}

RunsRecord readRuns(const Journal& journal, const Journal::FoundRecord& found) {
  const std::vector<std::byte> payload = journal.payload(found);
  RecordReader bytes(payload);
  RunsRecord record;
  record.set = bytes.get<std::uint64_t>();
  record.task = bytes.get<std::uint64_t>();
  if (bytes.get<bool>()) record.counts = getCounts(bytes);
  record.runs.resize(bytes.get<std::uint64_t>());
  for (WrittenRun& written : record.runs) {
    written.run.sequence = bytes.get<std::uint64_t>();
    written.run.offset = bytes.get<std::uint64_t>();
    written.run.points = bytes.get<std::uint32_t>();
    written.run.shape.axisBytes = bytes.get<std::uint32_t>();
    written.run.shape.constants = bytes.getAll<std::byte>();
    written.run.shape.kept = bytes.getAll<RunShape::Span>();
    written.run.cellsAt = found.offset + bytes.position() + sizeof(std::uint64_t);
    written.cells = bytes.getAll<RunCell>();
    written.run.cells = static_cast<std::uint32_t>(written.cells.size());
  }
  return record;
}

void appendSplit(Journal& journal, const SplitRecord& split) {
  RecordWriter bytes;
  bytes.put(split.set);
  bytes.put(split.cell);
  bytes.put(split.parent);
  bytes.put(split.levels);
  journal.append(RecordKind::split, bytes.bytes());
}

SplitRecord readSplit(const Journal& journal, const Journal::FoundRecord& found) {
  const std::vector<std::byte> payload = journal.payload(found);
  RecordReader bytes(payload);
  SplitRecord split;
  split.set = bytes.get<std::uint64_t>();
  split.cell = bytes.get<std::uint64_t>();
  split.parent = bytes.get<NodeKey>();
  split.levels = bytes.get<int>();
  return split;
}

void appendChunk(Journal& journal, const ChunkRecord& chunk) {
  RecordWriter bytes;
  bytes.put(chunk.top.points);  // first, for readTopPoints()
  bytes.put(chunk.index);
  bytes.put(chunk.top.key);
  bytes.put(chunk.written.end);
  bytes.put(chunk.written.checksum);
  bytes.putAll(std::span(chunk.written.nodes));
  bytes.putAll(std::span(chunk.top.children));
  journal.append(RecordKind::chunk, bytes.bytes());
}

SpilledBytes readTopPoints(const Journal& journal, const Journal::FoundRecord& found) {
  SpilledBytes points;
  if (found.bytes < sizeof points) throw Error(journal.path(), "tells too little of a chunk");
  journal.read(found.offset, std::as_writable_bytes(std::span(&points, 1)));
  return points;
}

std::vector<ChunkRecord> readChunks(const Journal& journal) {
  std::vector<ChunkRecord> chunks;
  for (const Journal::FoundRecord& found : journal.found()) {
    if (found.kind != RecordKind::chunk) continue;
    const std::vector<std::byte> payload = journal.payload(found);
    RecordReader bytes(payload);
    ChunkRecord chunk;
    chunk.top.points = bytes.get<SpilledBytes>();
    chunk.index = bytes.get<std::uint64_t>();
    chunk.top.key = bytes.get<NodeKey>();
    chunk.written.end = bytes.get<std::uint64_t>();
    chunk.written.checksum = bytes.get<std::uint64_t>();
    chunk.written.nodes = bytes.getAll<WrittenNode>();
    chunk.top.children = bytes.getAll<SubtreeShape>();
    // A chunk comes again, and with it all behind it, where points.bin was found damaged.
    if (chunk.index < chunks.size()) chunks.resize(chunk.index);
    if (chunk.index != chunks.size()) throw Error(journal.path(), "skips a chunk");
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

void appendComplete(Journal& journal) { journal.append(RecordKind::complete, {}); }

bool isComplete(const Journal& journal) {
  return !journal.found().empty() && journal.found().back().kind == RecordKind::complete;
}

}  // namespace strata
