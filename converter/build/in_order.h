#pragma once
#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <map>
#include <thread>
#include <utility>
#include <vector>

#include "core/mutex.h"

namespace strata {

/// Work that comes in numbered pieces.
template <typename T>
concept PiecesOfWork = requires(T work, std::size_t index, typename T::Piece piece) {
  { work.points(index) } -> std::convertible_to<std::uint64_t>;  // how much memory the piece takes; any thread
  { work.begin(index) } -> std::same_as<typename T::Piece>;      // one call at a time, in order
  work.build(index, piece);                                      // any thread
  work.finish(index, piece);                                     // one call at a time, in order
};

/// Begins pieces of work in order, builds them on several threads, and finishes them in order, one at a time. A thread
/// goes on with another piece while its own waits for an older one, because pieces differ in size by a factor of ten
/// and more. All pieces that have begun and are not finished have `pointsAtOnce` points together, or there is only one.
template <PiecesOfWork Work>
class InOrder {
 public:
  /// Works on the pieces first <= index < end. `work` must outlive this.
  InOrder(Work& work, std::size_t first, std::size_t end, std::uint64_t pointsAtOnce)
      : work_(work), end_(end), pointsAtOnce_(pointsAtOnce), next_(first) {}

  /// Uses at most `threads` threads, this one included, and returns when all pieces are finished. Throws what was
  /// thrown first. Called once.
  void run(std::size_t threads) STRATA_EXCLUDES(mutex_) {
    {
      std::vector<std::jthread> others;
      for (std::size_t i = 1; i < std::min(threads, pieces()); ++i) others.emplace_back([this] { workOn(); });
      workOn();
    }
    const MutexLock lock(mutex_);
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  using Piece = typename Work::Piece;

  std::size_t pieces() STRATA_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return end_ - next_;
  }

  /// Every thread runs this until no piece is left.
  void workOn() STRATA_EXCLUDES(mutex_) {
    try {
      std::size_t index = 0;
      while (waitForTurn(index)) {
        // No other thread begins a piece before hasBegun().
        Piece piece = work_.begin(index);
        hasBegun();
        work_.build(index, piece);
        finishFrom(index, std::move(piece));
      }
    } catch (...) {
      const MutexLock lock(mutex_);
      if (!thrown_) thrown_ = std::current_exception();
      beginning_ = false;
      changed_.notify_all();
    }
  }

  /// Waits until the next piece may begin; false when there is none or something was thrown.
  bool waitForTurn(std::size_t& index) STRATA_EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    while (!isOver() && (beginning_ || !hasRoom())) changed_.wait(mutex_);
    if (isOver()) return false;
    beginning_ = true;
    index = next_++;
    taken_ += work_.points(index);
    ++unfinished_;
    return true;
  }
  void hasBegun() STRATA_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    beginning_ = false;
    changed_.notify_all();
  }

  /// Finishes all built pieces whose turn it is, unless another thread does so already.
  void finishFrom(std::size_t built, Piece&& piece) STRATA_EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    built_.emplace(built, std::move(piece));
    while (!finishing_ && !thrown_ && !built_.empty() && built_.begin()->first + unfinished_ == next_) {
      const std::size_t index = built_.begin()->first;
      finishing_ = true;
      {
        Piece oldest = std::move(built_.begin()->second);
        built_.erase(built_.begin());
        lock.unlock();
        work_.finish(index, oldest);
      }
      lock.lock();
      finishing_ = false;
      --unfinished_;
      taken_ -= work_.points(index);
      changed_.notify_all();
    }
  }
  bool isOver() const STRATA_REQUIRES(mutex_) { return thrown_ != nullptr || next_ == end_; }
  bool hasRoom() const STRATA_REQUIRES(mutex_) { return taken_ == 0 || taken_ + work_.points(next_) <= pointsAtOnce_; }

  Work& work_;
  const std::size_t end_;
  const std::uint64_t pointsAtOnce_;

  Mutex mutex_;
  Condition changed_;
  std::size_t next_ STRATA_GUARDED_BY(mutex_);                    ///< the piece to begin
  std::map<std::size_t, Piece> built_ STRATA_GUARDED_BY(mutex_);  ///< pieces that wait to be finished, by index
  std::uint64_t taken_ STRATA_GUARDED_BY(mutex_) = 0;             ///< points of all pieces that are not finished
  std::size_t unfinished_ STRATA_GUARDED_BY(mutex_) = 0;          ///< pieces that have begun and are not finished
  bool beginning_ STRATA_GUARDED_BY(mutex_) = false;
  bool finishing_ STRATA_GUARDED_BY(mutex_) = false;
  std::exception_ptr thrown_ STRATA_GUARDED_BY(mutex_);
};

}  // namespace strata
