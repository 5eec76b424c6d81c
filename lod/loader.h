#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "lod/load_queue.h"
#include "lod/node_decoder.h"
#include "lod/node_reader.h"
#include "lod/streaming_state.h"
#include "lod/trace.h"

namespace strata {

/// The work of one loader thread. A request goes through it in this order:
///
///   - takeBuffer()     waits for an empty buffer: without one there is no room for a node
///   - takeRequests()   waits for the most urgent request; those that lie next to it in the file come along
///   - dropUnwanted()   forgets those that came, failed or went out of view since the LOD pass asked for them
///   - read()           reads all of them at once, through NodeReader
///   - decode()         fills a buffer for each and hands it to the render thread
///   - load()           reads those again that were asked for with too few bytes
///
/// A read or node that fails goes to FailedNodes instead. takeBuffer() and takeRequests() return false when the loader
/// has been stopped. Nothing is thrown.
class Loader {
 public:
  /// `state` has to outlive the loader, and the lane too, which may be null.
  Loader(StreamingState& state, const ReadLimits& limits, TraceLane* lane);

  /// Loads until stopped.
  void run(std::stop_token stop);

 private:
  bool takeBuffer(std::stop_token stop);
  bool hasBuffer();
  bool takeRequests(std::stop_token stop);
  void dropUnwanted();
  bool isStillWanted(const LoadRequest& request) const;
  void load(std::stop_token stop);
  void loadTogether(std::span<const LoadRequest> requests, std::stop_token stop);
  std::span<const std::byte> read(std::span<const LoadRequest> requests, std::stop_token stop);
  void decode(const LoadRequest& request, std::span<const std::byte> bytes);
  void fail(const LoadRequest& request, const std::string& reason);

  // Constant after construction.
  StreamingState& state_;
  const ReadLimits limits_;
  TraceLane* const lane_;

  // Used by the loader thread.
  NodeReader reader_;
  NodeDecoder decoder_;
  std::unique_ptr<StreamedNode> buffer_;  ///< empty, or null when it has been handed on
  std::vector<LoadRequest> requests_;     ///< taken together, by ascending offset
  std::vector<LoadRequest> tooShort_;     ///< those of them whose bytes held no points
};

}  // namespace strata
