#include "lod/node_reader.h"

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

namespace strata {

struct NodeReader::Exchange {
  enum class State { idle, asked, read, ended };

  // Guarded by mutex.
  std::mutex mutex;
  std::condition_variable_any changed;
  State state = State::idle;
  std::uint64_t offset = 0;
  std::exception_ptr failure;

  // Whose turn it is by `state`: asked = the reading thread's, else the loader's.
  std::vector<std::byte> bytes;
};

namespace {

/// Threads that are blocked in a read of a streamer that is gone. The one thing here that belongs to the process: it
/// is what lets a streamer's end not wait for the disk, without a detached thread.
class LateThreads {
 public:
  static LateThreads& ofProcess() {
    static LateThreads threads;
    return threads;
  }

  void add(std::jthread thread, std::function<bool()> hasEnded) {
    const std::lock_guard lock(mutex_);
    forgetEnded();
    threads_.push_back({std::move(hasEnded), std::move(thread)});
  }
  std::size_t count() {
    const std::lock_guard lock(mutex_);
    forgetEnded();
    return threads_.size();
  }

 private:
  struct Late {
    std::function<bool()> hasEnded;
    std::jthread thread;
  };
  /// Joins those that have nothing left to do.
  void forgetEnded() {
    std::erase_if(threads_, [](const Late& late) { return late.hasEnded(); });
  }

  std::mutex mutex_;
  std::vector<Late> threads_;
};

}  // namespace

NodeReader::NodeReader(std::shared_ptr<const Store> store)
    : exchange_(std::make_shared<Exchange>()),
      thread_([exchange = exchange_, store = std::move(store)](std::stop_token stop) {
        run(stop, *exchange, store->points());
      }) {}

NodeReader::~NodeReader() {
  thread_.request_stop();
  const auto hasEnded = [exchange = exchange_] {
    const std::lock_guard lock(exchange->mutex);
    return exchange->state == Exchange::State::ended;
  };
  {
    std::unique_lock lock(exchange_->mutex);
    exchange_->changed.wait_for(lock, kPatience, [this] { return exchange_->state == Exchange::State::ended; });
  }
  if (!hasEnded()) LateThreads::ofProcess().add(std::move(thread_), hasEnded);
}

std::span<const std::byte> NodeReader::read(std::uint64_t offset, std::size_t size, std::stop_token stop) {
  using State = Exchange::State;
  Exchange& exchange = *exchange_;
  exchange.bytes.resize(size);
  std::unique_lock lock(exchange.mutex);
  exchange.offset = offset;
  exchange.state = State::asked;
  exchange.changed.notify_all();
  exchange.changed.wait(lock, stop, [&] { return exchange.state == State::read; });
  if (exchange.state != State::read) return {};
  exchange.state = State::idle;
  if (exchange.failure != nullptr) std::rethrow_exception(std::exchange(exchange.failure, nullptr));
  return exchange.bytes;
}

void NodeReader::run(std::stop_token stop, Exchange& exchange, const ByteSource& source) {
  using State = Exchange::State;
  std::unique_lock lock(exchange.mutex);
  while (exchange.changed.wait(lock, stop, [&] { return exchange.state == State::asked; }) && !stop.stop_requested()) {
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
