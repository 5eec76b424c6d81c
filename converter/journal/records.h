#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "converter/journal/conversion_terms.h"
#include "converter/journal/journal.h"
#include "converter/journal/point_counts.h"
#include "converter/journal/run.h"
#include "converter/journal/spill.h"
#include "converter/subtree_shape.h"
#include "converter/survey/measure_extent.h"
#include "core/node_key.h"
#include "io/store/store.h"

/// Everything that a journal can say: a plain struct for each RecordKind, and the functions that append it and read it
/// back. No other file knows the bytes of a record. All functions throw Error where a record is damaged or missing.

namespace strata {

/// RecordKind::options, the first record of every journal.
struct JournalHead {
  std::string spillPath;  ///< empty = in the building folder
  ConversionTerms terms;
};
void appendHead(Journal& journal, const JournalHead& head);
JournalHead readHead(const Journal& journal);

/// RecordKind::measured.
void appendMeasured(Journal& journal, const MeasuredExtents& measured);
/// Returns nothing where the journal has no such record.
std::optional<MeasuredExtents> readMeasured(const Journal& journal);

/// RecordKind::runs: the points of one task of distributing or of splitting. A task is never written in part.
struct RunsRecord {
  std::uint64_t set = 0;              ///< number of the run set; set 0 has all points
  std::uint64_t task = 0;             ///< number of the task among those of the set
  std::optional<PointCounts> counts;  ///< of tasks of set 0
  std::vector<WrittenRun> runs;
};
/// Also sets Run::cellsAt and Run::cells of the runs.
void appendRuns(Journal& journal, RunsRecord& record);
RunsRecord readRuns(const Journal& journal, const Journal::FoundRecord& found);

/// RecordKind::split: how a cell of a run set is split.
struct SplitRecord {
  std::uint64_t set = 0, cell = 0;  ///< the run set, and the index of the cell in its grid
  NodeKey parent;                   ///< the smallest node that holds the cell's points, as far as was looked
  int levels = 0;                   ///< of the new run set below `parent`; 0 = the cell cannot be split further
};
void appendSplit(Journal& journal, const SplitRecord& split);
SplitRecord readSplit(const Journal& journal, const Journal::FoundRecord& found);

/// A node in points.bin, before nodes are linked to their children.
struct WrittenNode {
  NodeRecord record{};      ///< without firstChild, childMask and sliced
  std::uint32_t slice = 0;  ///< number in the chain of slices that continue a node; 0 = no slice
};

/// The nodes that a chunk left in points.bin.
struct WrittenChunk {
  std::uint64_t end = 0;       ///< bytes of points.bin with all of them
  std::uint64_t checksum = 0;  ///< of their payloads, each seeded with the one before
  std::vector<WrittenNode> nodes;
};

/// The top of a finished chunk. Its points wait in the spill because its ancestors still take some.
struct ChunkTop {
  NodeKey key;
  SpilledBytes points;                 ///< as BuiltChunk::topPoints
  std::vector<SubtreeShape> children;  ///< of the top's subtrees
};

/// RecordKind::chunk.
struct ChunkRecord {
  std::uint64_t index = 0;  ///< into Distribution::chunks
  WrittenChunk written;
  ChunkTop top;
};
void appendChunk(Journal& journal, const ChunkRecord& chunk);
/// The chunks that the journal found, by index.
std::vector<ChunkRecord> readChunks(const Journal& journal);
/// ChunkTop::points of a record of kind chunk, without reading the rest.
SpilledBytes readTopPoints(const Journal& journal, const Journal::FoundRecord& found);

/// RecordKind::complete.
void appendComplete(Journal& journal);
bool isComplete(const Journal& journal);

}  // namespace strata
