#include "lod/node_reader.h"

#include <exception>
#include <functional>
#include <utility>
#include <vector>

#include "core/mutex.h"

namespace strata {

struct NodeReader::Exchange {
  enum class State { idle, asked, read, ended };

  Condition changed;

  Mutex mutex;
  State state STRATA_GUARDED_BY(mutex) = State::idle;
  std::uint64_t offset STRATA_GUARDED_BY(mutex) = 0;
  std::exception_ptr failure STRATA_GUARDED_BY(mutex);

  // Used by one thread at a time, without the lock: by the reading thread while `state` is `asked`, else by the loader.
  std::vector<std::byte> bytes;

  bool hasEnded() STRATA_EXCLUDES(mutex) {
    const MutexLock lock(mutex);
    return state == State::ended;
  }
};

namespace {

/// Threads that are still blocked in a read although their streamer is gone. The list belongs to the process, so that a
/// streamer can end without waiting for the disk and without detaching a thread.
class LateThreads {
 public:
  static LateThreads& ofProcess() {
    static LateThreads threads;
    return threads;
  }

  void add(std::jthread thread, std::function<bool()> hasEnded) {
    const MutexLock lock(mutex_);
    forgetEnded();
    threads_.push_back({std::move(hasEnded), std::move(thread)});
  }
  std::size_t count() {
    const MutexLock lock(mutex_);
    forgetEnded();
    return threads_.size();
  }

 private:
  struct Late {
    std::function<bool()> hasEnded;
    std::jthread thread;
  };
  /// Joins those that have nothing left to do, which takes no time.
  void forgetEnded() STRATA_REQUIRES(mutex_) {
    std::erase_if(threads_, [](const Late& late) { return late.hasEnded(); });
  }

  Mutex mutex_;
  std::vector<Late> threads_ STRATA_GUARDED_BY(mutex_);
};

}  // namespace

NodeReader::NodeReader(std::shared_ptr<const Store> store)
    : exchange_(std::make_shared<Exchange>()),
      thread_([exchange = exchange_, store = std::move(store)](std::stop_token stop) {
        run(stop, *exchange, store->points());
      }) {}

NodeReader::~NodeReader() {
  thread_.request_stop();
  Exchange& exchange = *exchange_;
  {
    const MutexLock lock(exchange.mutex);
    exchange.changed.wait_for(exchange.mutex, kPatience, [&exchange]() STRATA_REQUIRES(exchange.mutex) {
      return exchange.state == Exchange::State::ended;
    });
  }
  if (!exchange.hasEnded())
    LateThreads::ofProcess().add(std::move(thread_), [shared = exchange_] { return shared->hasEnded(); });
}

std::span<const std::byte> NodeReader::read(std::uint64_t offset, std::size_t size, std::stop_token stop) {
  using State = Exchange::State;
  Exchange& exchange = *exchange_;
  exchange.bytes.resize(size);
  const MutexLock lock(exchange.mutex);
  exchange.offset = offset;
  exchange.state = State::asked;
  exchange.changed.notify_all();
  exchange.changed.wait(exchange.mutex, stop,
                        [&]() STRATA_REQUIRES(exchange.mutex) { return exchange.state == State::read; });
  if (exchange.state != State::read) return {};
  exchange.state = State::idle;
  if (exchange.failure != nullptr) std::rethrow_exception(std::exchange(exchange.failure, nullptr));
  return exchange.bytes;
}

void NodeReader::run(std::stop_token stop, Exchange& exchange, const ByteSource& source) {
  using State = Exchange::State;
  MutexLock lock(exchange.mutex);
  const auto isAsked = [&]() STRATA_REQUIRES(exchange.mutex) { return exchange.state == State::asked; };
  while (exchange.changed.wait(exchange.mutex, stop, isAsked) && !stop.stop_requested()) {
    const std::uint64_t offset = exchange.offset;
    lock.unlock();
    std::exception_ptr failure;
    try {
      source.read(offset, exchange.bytes);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    exchange.failure = std::move(failure);
    exchange.state = State::read;
    exchange.changed.notify_all();
  }
  exchange.state = State::ended;
  exchange.changed.notify_all();
}

std::size_t readersFinishingLater() { return LateThreads::ofProcess().count(); }

}  // namespace strata
