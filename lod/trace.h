#pragma once
#include <chrono>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

namespace strata {

using TraceClock = std::chrono::steady_clock;

/// A stretch of time in which a thread did one thing. The names are literals.
struct TraceSpan {
  const char* name = "";
  TraceClock::time_point begin, end;
  const char* countName = nullptr;  ///< the things that `count` counts, such as "bytes"; null for nothing
  std::uint64_t count = 0;
};

/// The spans of one thread. Only that thread writes them, and others read only after it has ended or while it rests.
/// Two spans of a lane are nested or apart.
class TraceLane {
 public:
  static constexpr std::size_t kMostSpans = std::size_t{1} << 20;  ///< 40 MB; further ones are only counted

  explicit TraceLane(std::string name) : name_(std::move(name)) {}

  void add(const TraceSpan& span) {
    if (spans_.size() < kMostSpans)
      spans_.push_back(span);
    else
      ++dropped_;
  }
  const std::string& name() const { return name_; }
  const std::vector<TraceSpan>& spans() const { return spans_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::string name_;
  std::vector<TraceSpan> spans_;
  std::uint64_t dropped_ = 0;
};

/// The lanes of several threads over the same time. A lane keeps its address.
class Trace {
 public:
  /// Call it before the lane's thread begins.
  TraceLane& addLane(std::string name) { return lanes_.emplace_back(std::move(name)); }
  const std::deque<TraceLane>& lanes() const { return lanes_; }
  TraceClock::time_point start() const { return start_; }

 private:
  TraceClock::time_point start_ = TraceClock::now();
  std::deque<TraceLane> lanes_;
};

/// A span from its construction to the end of its block. Without a lane it does nothing and does not read the clock.
class TraceScope {
 public:
  TraceScope(TraceLane* lane, const char* name) : lane_(lane) {
    if (lane_ != nullptr) span_ = {name, TraceClock::now(), {}, nullptr, 0};
  }
  ~TraceScope() { finish(); }
  TraceScope(const TraceScope&) = delete;
  TraceScope& operator=(const TraceScope&) = delete;

  /// Ends the span and begins the next one at the same moment.
  void next(const char* name) {
    if (const TraceClock::time_point now = finish(); lane_ != nullptr) span_ = {name, now, {}, nullptr, 0};
  }
  void count(const char* name, std::uint64_t count) {
    span_.countName = name;
    span_.count = count;
  }

 private:
  TraceClock::time_point finish() {
    if (lane_ == nullptr) return {};
    span_.end = TraceClock::now();
    lane_->add(span_);
    return span_.end;
  }

  TraceLane* const lane_;
  TraceSpan span_;
};

}  // namespace strata
