#include "viewer/bench/trace_file.h"

#include <algorithm>
#include <cstdio>

namespace strata {
namespace {

std::string nameEvent(const char* what, int thread, const std::string& name) {
  return std::string("{\"ph\":\"M\",\"pid\":1,\"tid\":") + std::to_string(thread) + ",\"name\":\"" + what +
         "\",\"args\":{\"name\":\"" + name + "\"}}";
}

std::string spanEvent(const TraceSpan& span, int thread, TraceClock::time_point start) {
  using Microseconds = std::chrono::duration<double, std::micro>;
  char text[240];
  std::snprintf(text, sizeof text, "{\"ph\":\"X\",\"pid\":1,\"tid\":%d,\"name\":\"%s\",\"ts\":%.3f,\"dur\":%.3f",
                thread, span.name, Microseconds(span.begin - start).count(),
                Microseconds(span.end - span.begin).count());
  std::string event = text;
  if (span.countName != nullptr)
    event += std::string(",\"args\":{\"") + span.countName + "\":" + std::to_string(span.count) + "}";
  return event + "}";
}

}  // namespace

std::string traceJson(const Trace& trace, const std::string& program) {
  std::string json = "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n" + nameEvent("process_name", 0, program);
  std::uint64_t dropped = 0;
  int thread = 0;
  for (const TraceLane& lane : trace.lanes()) {
    json += ",\n" + nameEvent("thread_name", ++thread, lane.name());
    std::vector<TraceSpan> spans = lane.spans();
    std::stable_sort(spans.begin(), spans.end(), [](const TraceSpan& a, const TraceSpan& b) {
      return a.begin != b.begin ? a.begin < b.begin : a.end > b.end;
    });
    for (const TraceSpan& span : spans) json += ",\n" + spanEvent(span, thread, trace.start());
    dropped += lane.dropped();
  }
  return json + "\n],\"otherData\":{\"program\":\"" + program + "\",\"dropped_spans\":" + std::to_string(dropped) +
         "}}\n";
}

}  // namespace strata
