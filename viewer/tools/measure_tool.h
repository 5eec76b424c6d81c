#pragma once
#include <optional>
#include <string>
#include <vector>

#include "viewer/tools/measurement.h"

namespace strata {

/// The measurements of a session, and the one that the clicks go to now.
class MeasureTool {
 public:
  /// Clicks go to a new measurement from now on; one that was begun is kept when it is whole.
  void begin(MeasureKind kind);
  bool active() const { return current_.has_value(); }
  /// Empty where none is active.
  const std::optional<Measurement>& current() const { return current_; }

  /// A click on a point. A measurement that has all its points is kept, and the next of its kind begins. The same point
  /// twice in a row counts once.
  void add(const glm::dvec3& point);
  /// What the next click is for: "distance: click the first point"; empty where none is active.
  std::string hint() const;
  /// Takes back the last click.
  void undo();
  /// Keeps what is whole and ends measuring.
  void finish();
  /// Ends measuring; drops what was begun.
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
