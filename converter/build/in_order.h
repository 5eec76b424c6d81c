#pragma once
#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace strata {

/// Takes pieces of work up in order, builds them on several threads, and finishes them in order, one at a time. A
/// thread goes on while its piece waits for an older one (they differ in size by a factor of ten and more), as long as
/// all that are neither finished nor waiting to be taken up have `pointsAtOnce` points together, or there is only one.
template <typename Work>
class InOrder {
 public:
  std::uint64_t pointsAtOnce = 0;
  std::size_t next = 0, end = 0;                   ///< pieces to take up
  std::function<std::uint64_t(std::size_t)> size;  ///< points of a piece
  std::function<Work(std::size_t)> begin;          ///< one call at a time, in order
  std::function<void(std::size_t, Work&)> build;   ///< on all threads
  std::function<void(std::size_t, Work&)> finish;  ///< one call at a time, in order

  /// At most `threads` of them, this one included. Throws what was thrown first.
  void run(std::size_t threads) {
    {
      std::vector<std::jthread> others;
      for (std::size_t i = 1; i < std::min(threads, end - next); ++i) others.emplace_back([this] { work(); });
      work();
    }
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    try {
      for (;;) {
        changed_.wait(lock, [&] { return over() || taken_ == 0 || taken_ + size(next) <= pointsAtOnce; });
        if (over()) return;
        Work piece = begin(next);
        const std::size_t index = next++;
        taken_ += size(index);
        ++unfinished_;
        lock.unlock();
        build(index, piece);
        lock.lock();
        built_.emplace(index, std::move(piece));
        finishAll(lock);
      }
    } catch (...) {
      if (!lock.owns_lock()) lock.lock();
      if (!thrown_) thrown_ = std::current_exception();
      changed_.notify_all();
    }
  }
  void finishAll(std::unique_lock<std::mutex>& lock) {
    while (!finishing_ && !thrown_ && !built_.empty() && built_.begin()->first + unfinished_ == next) {
      const std::size_t index = built_.begin()->first;
      finishing_ = true;
      {
        Work piece = std::move(built_.begin()->second);
        built_.erase(built_.begin());
        lock.unlock();
        finish(index, piece);
      }
      lock.lock();
      finishing_ = false;
      --unfinished_;
      taken_ -= size(index);
      changed_.notify_all();
    }
  }
  bool over() const { return thrown_ != nullptr || next == end; }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::size_t, Work> built_;  ///< by index; all of these guarded by mutex_, as is `next`
  std::uint64_t taken_ = 0;            ///< points of all that are not finished
  std::size_t unfinished_ = 0;
  bool finishing_ = false;
  std::exception_ptr thrown_;
};

}  // namespace strata
