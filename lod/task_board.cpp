#include "lod/task_board.h"

namespace strata {

TaskBoard::TaskBoard(const SelectionOptions& selection) { newest_.selection = selection; }

void TaskBoard::setView(const View& view, const std::optional<View>& ahead) {
  {
    const MutexLock lock(mutex_);
    if (viewKnown_ && newest_.view == view && newest_.ahead == ahead) return;
    newest_.view = view;
    newest_.ahead = ahead;
    viewKnown_ = true;
    ++newest_.generation;
  }
  lodWake_.notify_one();
}

void TaskBoard::setSelection(const SelectionOptions& selection) {
  {
    const MutexLock lock(mutex_);
    if (newest_.selection == selection) return;
    newest_.selection = selection;
    ++newest_.generation;
  }
  lodWake_.notify_one();
}

LodTask TaskBoard::newest() const {
  const MutexLock lock(mutex_);
  return newest_;
}

void TaskBoard::nodesChanged() {
  {
    const MutexLock lock(mutex_);
    nodesChanged_ = true;
  }
  lodWake_.notify_one();
}

void TaskBoard::loadEnded() {
  {
    const MutexLock lock(mutex_);
    ++events_;
  }
  eventHappened_.notify_all();
}

std::optional<LodTask> TaskBoard::waitForTask(std::stop_token stop, std::uint64_t lastGeneration) {
  const MutexLock lock(mutex_);
  const auto hasWork = [&]() STRATA_REQUIRES(mutex_) {
    return viewKnown_ && (newest_.generation != lastGeneration || nodesChanged_);
  };
  // Two calls: waiting until the end of time overflows in some standard libraries.
  if (nextPass_ == Clock::time_point::max())
    lodWake_.wait(mutex_, stop, hasWork);
  else
    lodWake_.wait_until(mutex_, stop, nextPass_, hasWork);
  if (stop.stop_requested()) return std::nullopt;
  nodesChanged_ = false;
  return newest_;
}

void TaskBoard::passEnded(std::uint64_t generation, bool isPending, Clock::time_point nextPass) {
  {
    const MutexLock lock(mutex_);
    doneGeneration_ = generation;
    donePending_ = isPending;
    nextPass_ = nextPass;
    ++events_;
  }
  eventHappened_.notify_all();
}

bool TaskBoard::complete() const {
  const MutexLock lock(mutex_);
  return viewKnown_ && doneGeneration_ == newest_.generation && !donePending_;
}

std::uint64_t TaskBoard::events() const {
  const MutexLock lock(mutex_);
  return events_;
}

bool TaskBoard::waitForEvent(std::uint64_t seen, Clock::time_point deadline) {
  const MutexLock lock(mutex_);
  return eventHappened_.wait_until(mutex_, deadline, [&]() STRATA_REQUIRES(mutex_) { return events_ != seen; });
}

}  // namespace strata
