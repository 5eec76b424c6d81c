#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "converter/build/node_builder.h"
#include "io/file/output_file.h"

namespace strata {

/// points.bin and the records of what is in it. Used by one thread at a time; the order of the calls is the order of
/// the file.
class NodeSink {
 public:
  /// What one chunk left in points.bin, up to `end`.
  struct Written {
    std::uint64_t end = 0;
    std::uint64_t checksum = 0;  ///< of its payloads, each seeded with the one before
    std::vector<NodeRecord> records;
  };

  /// `chunks`: what an interrupted conversion had written, empty when there was none. They are checked; those from
  /// the first on that is damaged are not counted.
  NodeSink(const std::string& folder, std::span<const Written> chunks);
  /// Chunks of an interrupted conversion that are there.
  std::size_t chunksFound() const { return chunksFound_; }

  void write(std::vector<BuiltNode> nodes);
  /// Hands everything to the system; returns what was written since the last call.
  Written endChunk();
  /// Completes points.bin and returns the records linked in breadth-first order.
  Hierarchy finish();
  std::uint64_t bytes() const { return file_->size() + buffer_.size(); }

 private:
  void flush();

  std::size_t chunksFound_ = 0;
  std::unique_ptr<OutputFile> file_;
  std::vector<std::byte> buffer_;
  std::vector<NodeRecord> records_;
  std::size_t chunkBegin_ = 0;       ///< index into records_
  std::uint64_t chunkChecksum_ = 0;  ///< of what the chunk has so far
};

}  // namespace strata
