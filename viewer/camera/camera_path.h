#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/view.h"

namespace strata {

/// The camera at one moment. World coordinates in metres; t in seconds.
struct CameraKey {
  double t = 0.0;
  glm::dvec3 eye{0.0};
  glm::dvec3 target{0.0};
  glm::dvec3 up{0.0, 0.0, 1.0};
  bool cut = false;   ///< the camera stays at the key before until now, then jumps here
  bool mark = false;  ///< a picture is taken here

  bool operator==(const CameraKey&) const = default;
};

/// keyed: each key is passed at its t. constant: the eye covers equal lengths in equal times between cuts, and the
/// keys' t only say when each of these runs begins and ends.
enum class PathSpeed : std::uint8_t { keyed, constant };

/// A scripted flight. The curve passes through every key.
struct CameraPath {
  double fps = 30.0;
  PathSpeed speed = PathSpeed::keyed;
  double fovY = 1.0471975511965976;  ///< radians; degrees in the file
  std::vector<CameraKey> keys;       ///< at least one, by strictly ascending t

  double duration() const { return keys.back().t - keys.front().t; }  ///< seconds
  /// Frames at k / fps from the first key to the last, both included.
  int frames() const;
};

/// The camera at `t` on the keys' own clock, held still before the first key, before each cut and after the last key.
/// Catmull and Rom 1974 for the eye and the target, with non-uniform knots as Barry and Goldman 1988; a path whose
/// last key repeats its first is taken for a closed loop, smooth there too. `up` is interpolated linearly.
View viewAt(const CameraPath& path, double t, int width, int height);

/// Converts between the time along a path and the clock of its keys, which viewAt() takes. They differ for a path of
/// constant speed and are the same for a keyed one.
class PathClock {
 public:
  explicit PathClock(const CameraPath& path);
  double keyTime(double pathTime) const { return lookUp(pathTimes_, keyTimes_, pathTime); }
  double pathTime(double keyTime) const { return lookUp(keyTimes_, pathTimes_, keyTime); }

 private:
  static double lookUp(const std::vector<double>& from, const std::vector<double>& to, double value);

  std::vector<double> pathTimes_, keyTimes_;  ///< ascending, in pairs; empty when the two clocks are the same
};

/// Returns the frames of the keys with `mark`, ascending. A flight saves the pictures of these frames.
std::vector<int> markedFrames(const CameraPath& path);
/// The first frame after each cut, ascending.
std::vector<int> cutFrames(const CameraPath& path);

/// The JSON text {"fps":30,"fov_y":60,"keys":[{"t":0,"eye":[x,y,z],"target":[x,y,z],"up":[0,0,1]}, ...]} and back.
/// `fps`, `fov_y` (degrees), `speed` ("keyed" or "constant") and of a key `up`, `cut` and `mark` may be absent.
/// parseCameraPath throws Error naming `file` and what is wrong: `path.json: key 3: t 1.0 is not after 2.0`.
std::string cameraPathJson(const CameraPath& path);
CameraPath parseCameraPath(const std::string& file, const std::string& json);
CameraPath readCameraPath(const std::string& file);

}  // namespace strata
