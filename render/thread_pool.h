#pragma once
#include <cstddef>
#include <functional>
#include <memory>

namespace strata {

/// A bounded set of worker threads (a TBB arena). The thread that calls is one of them. Several threads may share a
/// pool.
class ThreadPool {
 public:
  /// 0 threads means one per core.
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int threads() const;
  /// Calls body(begin, end) for ranges that together cover [0, count), each at most `grain` long. Returns when all
  /// calls have returned.
  void parallelFor(std::size_t count, std::size_t grain,
                   const std::function<void(std::size_t, std::size_t)>& body) const;
  /// The same with body(begin, end, slot). Two calls that run at the same time have different slots in [0, threads()).
  void parallelForSlots(std::size_t count, std::size_t grain,
                        const std::function<void(std::size_t, std::size_t, std::size_t)>& body) const;

 private:
  struct Arena;
  std::unique_ptr<Arena> arena_;
};

}  // namespace strata
