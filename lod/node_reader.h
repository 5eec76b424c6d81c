#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <thread>

#include "io/store/store.h"

namespace strata {

/// Reads for one loader on a thread of its own, so that the loader can be stopped while a read is blocked: no call
/// makes a read return that a dead disk or server holds up. Everything that the reading thread touches (the store, its
/// buffer, the way back) is held by shared ownership. Stopped while reading, it is waited for kPatience and then left
/// to finishLater(), which joins it when the read has returned, or at the end of the process. The store is closed by
/// whoever lets go of it last, which may then be that thread.
class NodeReader {
 public:
  /// Longer than nearly all reads take.
  static constexpr std::chrono::milliseconds kPatience{20};

  explicit NodeReader(std::shared_ptr<const Store> store);
  ~NodeReader();
  NodeReader(const NodeReader&) = delete;
  NodeReader& operator=(const NodeReader&) = delete;

  /// Reads from points.bin and waits for it. The bytes are valid until the next read; empty when stopped meanwhile,
  /// after which there is no further reading. Throws what the source threw.
  std::span<const std::byte> read(std::uint64_t offset, std::size_t size, std::stop_token stop);

 private:
  struct Exchange;
  static void run(std::stop_token stop, Exchange& exchange, const ByteSource& source);

  std::shared_ptr<Exchange> exchange_;
  std::jthread thread_;
};

/// Reading threads that were still blocked when their loader had stopped: 0 except after stopping under a slow source.
std::size_t readersFinishingLater();

}  // namespace strata
