#pragma once
#include <cstddef>
#include <vector>

#include "core/view.h"
#include "viewer/camera/camera_path.h"

namespace strata {

/// Picks from `samples`, in their order, the keys that a path needs to pass every sample's eye and target within
/// `tolerance`, a share of the sample's distance to its target. The first and the last sample are always picked.
std::vector<CameraKey> thinned(const std::vector<CameraKey>& samples, double tolerance);

/// A camera path made by hand: keys are set one by one, or recorded while the camera moves. Keys always have
/// perspective. A key that is set in an orthographic view shows things at the target in the same size.
class PathRecorder {
 public:
  static constexpr double kKeySeconds = 2.0;     ///< from a key to the next one that is set by hand
  static constexpr double kTolerance = 0.005;    ///< for thinned(): about four pixels in a picture of 1080 rows
  static constexpr double kLeastSeconds = 0.01;  ///< between keys

  const std::vector<CameraKey>& keys() const { return keys_; }
  /// Replaces all keys.
  void setKeys(std::vector<CameraKey> keys);

  void addKey(const View& view);
  void replaceKey(std::size_t index, const View& view);
  void removeKey(std::size_t index);
  /// Moves a key, which is not the first one, to `seconds` after the key before it. Later keys move along.
  void setStep(std::size_t index, double seconds);

  /// From now on record() adds a key for each frame, behind the keys that exist already.
  void beginRecording(const View& view);
  /// Adds the view of a frame, `seconds` after the frame before it.
  void record(const View& view, double seconds);
  /// Keeps only the recorded keys that the path needs. A recording without motion becomes one key.
  void endRecording();
  bool recording() const { return recording_; }

  /// The path through the keys, of which there must be at least one.
  CameraPath path(double fovY, double fps) const;

 private:
  std::vector<CameraKey> keys_;
  std::vector<CameraKey> samples_;
  double clock_ = 0.0;
  bool recording_ = false;
};

}  // namespace strata
