#pragma once
#include <optional>
#include <string>
#include <vector>

#include "viewer/tools/measurement.h"

namespace strata {

/// The measurements of a session, and the current one, to which clicks add points.
class MeasureTool {
 public:
  /// Begins a new measurement. The current one is kept if it is complete.
  void begin(MeasureKind kind);
  bool active() const { return current_.has_value(); }
  /// Nothing when no measurement is active.
  const std::optional<Measurement>& current() const { return current_; }

  /// Adds a clicked point. A measurement that has all its points is kept, and the next one of its kind begins. The same
  /// point twice in a row counts once.
  void add(const glm::dvec3& point);
  /// The meaning of the next click: "distance: click the first point"; empty when no measurement is active.
  std::string hint() const;
  /// Takes back the last click.
  void undo();
  /// Keeps the current measurement if it is complete, and ends measuring.
  void finish();
  /// Drops the current measurement and ends measuring.
  void cancel() { current_.reset(); }

  std::vector<Measurement>& kept() { return kept_; }
  const std::vector<Measurement>& kept() const { return kept_; }

 private:
  void keepCurrent();
  /// "distance 3": the first number that no measurement of the kind has.
  std::string freeName(MeasureKind kind) const;

  std::optional<Measurement> current_;
  std::vector<Measurement> kept_;
};

}  // namespace strata
