#pragma once
#include <cstddef>
#include <functional>
#include <memory>

namespace strata {

/// A bounded set of worker threads (a TBB arena). The calling thread is one of them.
class ThreadPool {
 public:
  /// `threads` 0 means all cores.
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int threads() const;
  /// Calls body(begin, end) over parts of [0, count) of at most `grain` each; returns when all are done.
  void parallelFor(std::size_t count, std::size_t grain,
                   const std::function<void(std::size_t, std::size_t)>& body) const;
  /// The same with body(begin, end, slot): a slot in [0, threads()) is used by one thread at a time.
  void parallelForSlots(std::size_t count, std::size_t grain,
                        const std::function<void(std::size_t, std::size_t, std::size_t)>& body) const;

 private:
  struct Arena;
  std::unique_ptr<Arena> arena_;
};

}  // namespace strata
