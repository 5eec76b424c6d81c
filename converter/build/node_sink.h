#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "converter/build/node_builder.h"
#include "converter/journal/records.h"
#include "io/file/output_file.h"

namespace strata {

/// Writes points.bin and collects the records of its nodes. Used by one thread at a time; nodes lie in the file in the
/// order of the calls. Failures throw Error.
class NodeSink {
 public:
  /// Goes on behind the chunks that an interrupted conversion left in `folder`. It checks them, and forgets the first
  /// one that is damaged and all behind it.
  NodeSink(const std::string& folder, std::span<const WrittenChunk> chunks);
  /// The number of those chunks that are sound.
  std::size_t chunksFound() const { return chunksFound_; }

  void write(std::vector<BuiltNode> nodes);
  /// Hands everything to the system and returns what was written since the last call.
  WrittenChunk endChunk();
  /// Completes points.bin and returns the records linked in breadth-first order. Called once, last.
  Hierarchy finish();
  /// The size of points.bin with everything that was written.
  std::uint64_t bytes() const { return file_->size() + buffer_.size(); }

 private:
  void flush();

  std::size_t chunksFound_ = 0;
  std::unique_ptr<OutputFile> file_;
  std::vector<std::byte> buffer_;
  std::vector<WrittenNode> nodes_;
  std::size_t chunkBegin_ = 0;       ///< index into nodes_
  std::uint64_t chunkChecksum_ = 0;  ///< as WrittenChunk::checksum, of the chunk that has not ended
};

}  // namespace strata
