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
/// Where `point` appears. It has to lie before the eye.
glm::dvec2 pixelOf(const View& view, const glm::dvec3& point);

/// The part of the segment that lies before the near plane, as pixels; nothing where none does.
std::optional<std::pair<glm::dvec2, glm::dvec2>> segmentOnScreen(const View& view, glm::dvec3 a, glm::dvec3 b);

/// Turns around `pivot`: half a turn for a drag over the image's width. The distance to the pivot stays, the horizon
/// stays level, and the camera never tips over.
View orbited(const View& view, const glm::dvec3& pivot, const glm::dvec2& dragPx);
/// Shifts so that what lies `depth` metres away follows the cursor exactly.
View panned(const View& view, double depth, const glm::dvec2& dragPx);
/// Slides level over the ground, as a hand moves a map: `grabbed`, a point of the ground, comes under the cursor. Where
/// the cursor is at the horizon of the level plane through the point, or above it, the view stays.
inline constexpr double kFarthestSlide = 20.0;  ///< times the distance of the grabbed point
View slid(const View& view, const glm::dvec3& grabbed, const glm::dvec2& cursor);
/// Turns the head: as orbited() about the eye.
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
/// All of `box` from the south, the east or above.
View standardView(const View& view, const Box& box, StandardView which);
/// All of `box`, from where the camera looks now.
View framed(const View& view, const Box& box);

/// The same view without perspective, or with it again; what lies at the target keeps its size.
View withOrthographic(const View& view, bool orthographic);
/// `point` in the middle of the picture, at 0.4 of its distance, seen from the same direction.
View approached(const View& view, const glm::dvec3& point);
/// Where a glide is after share `u` of its way, 0 to 1: the target moves straight, the eye swings around it, the
/// distance changes by equal ratios in equal times; it starts and ends slowly.
View glided(const View& from, const View& to, double u);

/// Where the camera will be if it goes on as it does: by the change of the view over the last frame.
class CameraMotion {
 public:
  static constexpr double kAheadSeconds = 0.5;

  /// Once a frame, with the view of this frame.
  View ahead(const View& now, std::chrono::steady_clock::time_point time);

 private:
  View last_;
  std::chrono::steady_clock::time_point lastTime_{};
};

/// What the left button, the right button and the wheel do.
enum class MoveMode {
  orbit,  ///< orbits, pans, goes nearer
  fly,    ///< turns the head, pans, sets the pace
  earth   ///< slides over the ground, orbits, goes nearer
};

const char* modeName(MoveMode mode);  ///< "orbit", "fly", "earth"
MoveMode nextMode(MoveMode mode);

/// What a drag in progress needs to remember. `under` is the world point below the cursor where something is drawn.
class CameraControl {
 public:
  enum class Drag { none, orbit, pan, look, slide };

  explicit CameraControl(const View& view) : view_(view) {}

  const View& view() const { return view_; }
  void setView(const View& view) {
    view_ = view;
    glide_.reset();
  }
  /// Goes there within kGlideSeconds; what the hand does meanwhile stops it.
  static constexpr double kGlideSeconds = 0.6;
  void glideTo(const View& view) { glide_ = Glide{view_, view, 0.0}; }
  bool gliding() const { return glide_.has_value(); }
  /// `seconds` later.
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
