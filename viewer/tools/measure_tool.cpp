#include "viewer/tools/measure_tool.h"

#include <algorithm>

namespace strata {

std::string MeasureTool::freeName(MeasureKind kind) const {
  for (int number = 1;; ++number) {
    const std::string name = std::string(measureName(kind)) + " " + std::to_string(number);
    if (std::none_of(kept_.begin(), kept_.end(), [&](const Measurement& m) { return m.name == name; })) return name;
  }
}

void MeasureTool::keepCurrent() {
  if (current_ && current_->points.size() >= leastPoints(current_->kind)) {
    if (current_->kind == MeasureKind::profile) current_->width = profileWidth(current_->points);
    kept_.push_back(std::move(*current_));
  }
  current_.reset();
}

void MeasureTool::begin(MeasureKind kind) {
  keepCurrent();
  current_ = Measurement{freeName(kind), kind, {}, true, 1.0};
}

void MeasureTool::add(const glm::dvec3& point) {
  if (!current_) return;
  if (!current_->points.empty() && current_->points.back() == point) return;
  current_->points.push_back(point);
  if (const MeasureKind kind = current_->kind; current_->points.size() == mostPoints(kind)) begin(kind);
}

std::string MeasureTool::hint() const {
  if (!current_) return {};
  const std::size_t least = leastPoints(current_->kind), count = current_->points.size();
  std::string text = std::string(measureName(current_->kind)) + ": ";
  if (count == 0) return text + (least == 1 ? "click a point" : "click the first point");
  if (count < least) return text + "click the next point";
  return text + "click the next point, or double click to end";
}

void MeasureTool::undo() {
  if (current_ && !current_->points.empty()) current_->points.pop_back();
}

void MeasureTool::finish() { keepCurrent(); }

}  // namespace strata
