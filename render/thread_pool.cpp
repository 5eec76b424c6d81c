#include "render/thread_pool.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace strata {

struct ThreadPool::Arena {
  explicit Arena(int threads) : arena(threads > 0 ? threads : tbb::task_arena::automatic) {}
  tbb::task_arena arena;
};

ThreadPool::ThreadPool(int threads) : arena_(std::make_unique<Arena>(threads)) {}
ThreadPool::~ThreadPool() = default;

int ThreadPool::threads() const { return arena_->arena.max_concurrency(); }

void ThreadPool::parallelFor(std::size_t count, std::size_t grain,
                             const std::function<void(std::size_t, std::size_t)>& body) const {
  parallelForSlots(count, grain, [&](std::size_t begin, std::size_t end, std::size_t) { body(begin, end); });
}

void ThreadPool::parallelForSlots(std::size_t count, std::size_t grain,
                                  const std::function<void(std::size_t, std::size_t, std::size_t)>& body) const {
  if (count == 0) return;
  arena_->arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, std::max<std::size_t>(grain, 1)),
        [&](const tbb::blocked_range<std::size_t>& range) {
          const int slot = std::max(tbb::this_task_arena::current_thread_index(), 0);
          body(range.begin(), range.end(), static_cast<std::size_t>(slot));
        },
        tbb::simple_partitioner());
  });
}

}  // namespace strata
