#pragma once
#include <chrono>
#include <optional>
#include <utility>

#include <glm/glm.hpp>

#include "core/box.h"
#include "core/view.h"

namespace strata {

// How a hand moves the camera: plain functions from a view and an input to the next view. Pixels have their origin
// at the top left. World z is up throughout.

/// The world point seen at `pixel` at `depth` metres along the view direction.
glm::dvec3 worldPoint(const View& view, const glm::dvec2& pixel, double depth);
/// Metres along the view direction from the eye to `point`.
double depthOf(const View& view, const glm::dvec3& point);
/// The pixel in which `point` appears. It must lie in front of the eye.
glm::dvec2 pixelOf(const View& view, const glm::dvec3& point);

/// The part of the segment that lies beyond the near plane, as pixels; nothing when all of it is nearer.
std::optional<std::pair<glm::dvec2, glm::dvec2>> segmentOnScreen(const View& view, glm::dvec3 a, glm::dvec3 b);

/// Turns around `pivot`: half a turn for a drag over the image's width. The distance to the pivot stays, the horizon
/// stays level, and the camera never tips over.
View orbited(const View& view, const glm::dvec3& pivot, const glm::dvec2& dragPx);
/// Shifts the camera so that things `depth` metres away follow the cursor exactly.
View panned(const View& view, double depth, const glm::dvec2& dragPx);
inline constexpr double kFarthestSlide = 20.0;  ///< times the distance of the grabbed point
/// Slides level over the ground, as a hand moves a map: `grabbed`, a point of the ground, comes under the cursor. If
/// the cursor is at or above the horizon of the level plane through that point, the view stays.
View slid(const View& view, const glm::dvec3& grabbed, const glm::dvec2& cursor);
/// Turns the head: the same turn as orbited(), about the eye.
View looked(const View& view, const glm::dvec2& dragPx);
/// Scales the distance to `anchor` by `factor`; the anchor stays under the cursor.
View zoomed(const View& view, const glm::dvec3& anchor, double factor);

/// Directions held down, each -1, 0 or 1.
struct FlyInput {
  int forward = 0, right = 0, up = 0;
  bool fast = false;

  bool still() const { return forward == 0 && right == 0 && up == 0; }
};
/// Metres a second: half the distance to the target, five times that when fast. Near things are passed slowly, and a
/// zoom sets the pace.
double flySpeed(const View& view, bool fast);
/// The same eye with its target nearer (slower) or farther (faster) along the view, as a zoom's notches would.
View paced(const View& view, double notches);
/// Moves eye and target.
View flown(const View& view, const FlyInput& input, double seconds);

enum class StandardView { front, side, top };
/// A view of all of `box` from the south, the east or above.
View standardView(const View& view, const Box& box, StandardView which);
/// A view of all of `box` from the present direction.
View framed(const View& view, const Box& box);

/// The same view without perspective, or with it again; things at the target keep their size.
View withOrthographic(const View& view, bool orthographic);
/// A view in the same direction with `point` in the middle of the picture, at 0.4 of its distance.
View approached(const View& view, const glm::dvec3& point);
/// The view of a glide after the share `u` of its time, 0 to 1. The target moves straight, the eye swings around it,
/// and the distance changes by equal ratios in equal times. A glide starts and ends slowly.
View glided(const View& from, const View& to, double u);

/// Predicts the view a little ahead from the change of the view over the last frame.
class CameraMotion {
 public:
  static constexpr double kAheadSeconds = 0.5;

  /// Must be called once per frame, with the view of this frame.
  View ahead(const View& now, std::chrono::steady_clock::time_point time);

 private:
  View last_;
  std::chrono::steady_clock::time_point lastTime_{};
};

/// Decides what the left button, the right button and the wheel do.
enum class MoveMode {
  orbit,  ///< orbits, pans, goes nearer
  fly,    ///< turns the head, pans, sets the pace
  earth   ///< slides over the ground, orbits, goes nearer
};

const char* modeName(MoveMode mode);  ///< "orbit", "fly", "earth"
MoveMode nextMode(MoveMode mode);

/// The camera in the user's hand: drags, the wheel, flying and glides change its view. `under` is the world point below
/// the cursor, if a point is drawn there.
class CameraControl {
 public:
  enum class Drag { none, orbit, pan, look, slide };

  explicit CameraControl(const View& view) : view_(view) {}

  const View& view() const { return view_; }
  void setView(const View& view) {
    view_ = view;
    glide_.reset();
  }
  static constexpr double kGlideSeconds = 0.6;
  /// Begins a glide to `view`, which takes kGlideSeconds. Any movement by hand stops it.
  void glideTo(const View& view) { glide_ = Glide{view_, view, 0.0}; }
  bool gliding() const { return glide_.has_value(); }
  /// Moves a glide on by `seconds`.
  void advance(double seconds);
  void resize(int width, int height);

  MoveMode mode() const { return mode_; }
  void setMode(MoveMode mode) { mode_ = mode; }
  /// The left or the right button goes down, and means what the mode says.
  void pressLeft(const glm::dvec2& cursor, const std::optional<glm::dvec3>& under);
  void pressRight(const glm::dvec2& cursor, const std::optional<glm::dvec3>& under);
  void press(Drag drag, const glm::dvec2& cursor, const std::optional<glm::dvec3>& under);
  void move(const glm::dvec2& cursor);
  void release() { drag_ = Drag::none; }
  /// Positive notches go nearer.
  void wheel(double notches, const glm::dvec2& cursor, const std::optional<glm::dvec3>& under);
  void fly(const FlyInput& input, double seconds) { setView(flown(view_, input, seconds)); }

 private:
  struct Glide {
    View from, to;
    double u = 0.0;
  };
  std::optional<Glide> glide_;
  MoveMode mode_ = MoveMode::orbit;
  View view_;
  Drag drag_ = Drag::none;
  glm::dvec2 cursor_{0.0};
  glm::dvec3 anchor_{0.0};  ///< pivot of an orbit, grabbed point of a pan
};

}  // namespace strata
