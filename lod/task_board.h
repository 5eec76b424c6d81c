#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <stop_token>

#include "core/mutex.h"
#include "lod/lod_task.h"

namespace strata {

/// The place where the threads of a streamer leave word for each other: which task is the newest, that nodes have come
/// or failed, and which task the last list was made for. Any thread may call any member, unless a thread is named.
class TaskBoard {
 public:
  using Clock = std::chrono::steady_clock;

  explicit TaskBoard(const SelectionOptions& selection);

  /// Wakes the LOD thread, unless the newest task has these views already.
  void setView(const View& view, const std::optional<View>& ahead);
  /// Wakes the LOD thread, unless the newest task has these options already.
  void setSelection(const SelectionOptions& selection);
  LodTask newest() const;

  /// Nodes have come or failed: wakes the LOD thread for another pass over the same task.
  void nodesChanged();
  /// A load has ended: wakes the render thread out of waitForEvent().
  void loadEnded();

  /// LOD thread: waits until there is a task newer than `lastGeneration`, nodes have changed, or the time has come that
  /// the last passEnded() named. Empty when stopped.
  std::optional<LodTask> waitForTask(std::stop_token stop, std::uint64_t lastGeneration);
  /// LOD thread: the list for the task of this generation has been published. `isPending` says that it lacks something
  /// that can still come; without any other reason, the next pass is due at `nextPass`.
  void passEnded(std::uint64_t generation, bool isPending, Clock::time_point nextPass);

  /// True when a list has been published for the newest task that lacks nothing that can still come.
  bool complete() const;

  /// Counts the lists published and the loads ended.
  std::uint64_t events() const;
  /// Render thread: waits until events() is no longer `seen`. False when that took too long.
  bool waitForEvent(std::uint64_t seen, Clock::time_point deadline);

 private:
  Condition lodWake_;
  Condition eventHappened_;

  mutable Mutex mutex_;
  LodTask newest_ STRATA_GUARDED_BY(mutex_);
  bool viewKnown_ STRATA_GUARDED_BY(mutex_) = false;     ///< setView() has been called
  bool nodesChanged_ STRATA_GUARDED_BY(mutex_) = false;  ///< since the last pass began
  Clock::time_point nextPass_ STRATA_GUARDED_BY(mutex_) = Clock::time_point::max();
  std::uint64_t doneGeneration_ STRATA_GUARDED_BY(mutex_) = 0;  ///< the task of the last published list
  bool donePending_ STRATA_GUARDED_BY(mutex_) = false;          ///< that list lacks something that can still come
  std::uint64_t events_ STRATA_GUARDED_BY(mutex_) = 0;
};

}  // namespace strata
