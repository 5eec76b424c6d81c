#pragma once
#include <cstddef>
#include <vector>

#include "core/view.h"
#include "viewer/camera/camera_path.h"

namespace strata {

/// The keys of `samples`, in their order, that a path needs to come within `tolerance` of every sample: as a share of
/// the sample's distance to its target, for the eye and for the target. The first and the last stay.
std::vector<CameraKey> thinned(const std::vector<CameraKey>& samples, double tolerance);

/// A camera path made by hand: keys set one by one, or taken down while the camera moves. Keys have perspective: of a
/// view without, what is seen at the target keeps its size.
class PathRecorder {
 public:
  static constexpr double kKeySeconds = 2.0;     ///< from a key to one set after it
  static constexpr double kTolerance = 0.005;    ///< of thinned(), about four pixels of a 1080 rows' picture
  static constexpr double kLeastSeconds = 0.01;  ///< between keys

  const std::vector<CameraKey>& keys() const { return keys_; }
  /// Throws away what was there.
  void setKeys(std::vector<CameraKey> keys);

  void addKey(const View& view);
  void replaceKey(std::size_t index, const View& view);
  void removeKey(std::size_t index);
  /// The key takes place `seconds` after the one before it; what follows keeps its distances. Not for the first.
  void setStep(std::size_t index, double seconds);

  /// From here on record() takes down a key for each frame, behind the keys that are there.
  void beginRecording(const View& view);
  /// `seconds` after the last frame.
  void record(const View& view, double seconds);
  /// Leaves of the recorded keys those that the path needs. A recording without motion is one key.
  void endRecording();
  bool recording() const { return recording_; }

  /// The path of the keys. Not without any.
  CameraPath path(double fovY, double fps) const;

 private:
  std::vector<CameraKey> keys_;
  std::vector<CameraKey> samples_;
  double clock_ = 0.0;
  bool recording_ = false;
};

}  // namespace strata
