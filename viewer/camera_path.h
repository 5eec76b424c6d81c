#pragma once
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/view.h"

namespace strata {

/// Where the camera is at a moment. World coordinates, metres; t in seconds.
struct CameraKey {
  double t = 0.0;
  glm::dvec3 eye{0.0};
  glm::dvec3 target{0.0};
  glm::dvec3 up{0.0, 0.0, 1.0};

  bool operator==(const CameraKey&) const = default;
};

/// A scripted flight: what a benchmark plays. The curve passes through every key.
struct CameraPath {
  double fps = 30.0;
  double fovY = 1.0471975511965976;  ///< radians; degrees in the file
  std::vector<CameraKey> keys;       ///< at least one, by strictly ascending t

  double duration() const { return keys.back().t - keys.front().t; }  ///< seconds
  /// Frames at k / fps from the first key to the last, both included.
  int frames() const;
};

/// The camera at `t`, held still before the first key and after the last.
/// Catmull and Rom 1974 for the eye and the target, with non-uniform knots as Barry and Goldman 1988; a path whose
/// last key repeats its first is taken for a closed loop, smooth there too. `up` is interpolated linearly.
View viewAt(const CameraPath& path, double t, int width, int height);

/// The JSON text {"fps":30,"fov_y":60,"keys":[{"t":0,"eye":[x,y,z],"target":[x,y,z],"up":[0,0,1]}, ...]} and back.
/// `fps`, `fov_y` (degrees) and `up` may be absent. parseCameraPath throws Error naming `file` and what is wrong:
/// `path.json: key 3: t 1.0 is not after 2.0`.
std::string cameraPathJson(const CameraPath& path);
CameraPath parseCameraPath(const std::string& file, const std::string& json);
CameraPath readCameraPath(const std::string& file);

}  // namespace strata
