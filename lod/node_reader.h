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

/// Reads for one loader on a thread of its own, so that the loader can be stopped while a read is blocked: nothing can
/// interrupt a read from a dead disk or server. The reading thread shares the ownership of everything that it touches:
/// the store and the exchange with the loader, buffer included. The destructor waits kPatience for a read. A thread
/// that is still reading then goes to a list of the process, which joins it once the read has returned, at the latest
/// at the end of the process. So that thread may be the last owner of the store, and close it.
class NodeReader {
 public:
  /// Nearly all reads take less time than this.
  static constexpr std::chrono::milliseconds kPatience{20};

  explicit NodeReader(std::shared_ptr<const Store> store);
  ~NodeReader();
  NodeReader(const NodeReader&) = delete;
  NodeReader& operator=(const NodeReader&) = delete;

  /// Reads from points.bin and waits for the bytes, which are valid until the next read. They are empty when `stop`
  /// came first; the reader must not be used after that. Throws what the source threw.
  std::span<const std::byte> read(std::uint64_t offset, std::size_t size, std::stop_token stop);

 private:
  struct Exchange;
  static void run(std::stop_token stop, Exchange& exchange, const ByteSource& source);

  std::shared_ptr<Exchange> exchange_;
  std::jthread thread_;
};

/// How many reading threads are still blocked although their loader has stopped; for tests.
std::size_t readersFinishingLater();

}  // namespace strata
