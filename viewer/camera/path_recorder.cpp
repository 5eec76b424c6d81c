#include "viewer/camera/path_recorder.h"

#include <algorithm>
#include <utility>

#include "viewer/camera/camera_control.h"

namespace strata {
namespace {

CameraKey keyOf(const View& seen, double t) {
  const View view = withOrthographic(seen, false);
  CameraKey key;
  key.t = t;
  key.eye = view.eye;
  key.target = view.target;
  key.up = view.up;
  return key;
}

/// How far the path is from the sample, as a share of its distance to its target.
double missOf(const CameraPath& path, const CameraKey& sample) {
  const View view = viewAt(path, sample.t, 1, 1);
  const double miss = std::max({glm::distance(view.eye, sample.eye), glm::distance(view.target, sample.target)});
  const double away = std::max(glm::distance(sample.eye, sample.target), 1e-12);
  return std::max(miss / away, glm::distance(view.up, sample.up));
}

}  // namespace

std::vector<CameraKey> thinned(const std::vector<CameraKey>& samples, double tolerance) {
  if (samples.size() < 3) return samples;
  std::vector<std::size_t> kept{0, samples.size() - 1};
  while (true) {
    CameraPath path;
    for (const std::size_t i : kept) path.keys.push_back(samples[i]);
    // The worst sample of each gap becomes a key, so that a long path takes few rounds.
    std::vector<std::size_t> more;
    for (std::size_t k = 0; k + 1 < kept.size(); ++k) {
      double worst = tolerance;
      std::size_t at = 0;
      for (std::size_t i = kept[k] + 1; i < kept[k + 1]; ++i)
        if (const double miss = missOf(path, samples[i]); miss > worst) {
          worst = miss;
          at = i;
        }
      if (at > 0) more.push_back(at);
    }
    if (more.empty()) return path.keys;
    kept.insert(kept.end(), more.begin(), more.end());
    std::sort(kept.begin(), kept.end());
  }
}

void PathRecorder::setKeys(std::vector<CameraKey> keys) {
  keys_ = std::move(keys);
  samples_.clear();
  recording_ = false;
}

void PathRecorder::addKey(const View& view) {
  keys_.push_back(keyOf(view, keys_.empty() ? 0.0 : keys_.back().t + kKeySeconds));
}

void PathRecorder::replaceKey(std::size_t index, const View& view) {
  if (index < keys_.size()) keys_[index] = keyOf(view, keys_[index].t);
}

void PathRecorder::removeKey(std::size_t index) {
  if (index >= keys_.size()) return;
  keys_.erase(keys_.begin() + static_cast<std::ptrdiff_t>(index));
  if (index > 0 || keys_.empty()) return;
  const double first = keys_.front().t;
  for (CameraKey& key : keys_) key.t -= first;
}

void PathRecorder::setStep(std::size_t index, double seconds) {
  if (index == 0 || index >= keys_.size()) return;
  const double later = std::max(seconds, kLeastSeconds) - (keys_[index].t - keys_[index - 1].t);
  for (std::size_t i = index; i < keys_.size(); ++i) keys_[i].t += later;
}

void PathRecorder::beginRecording(const View& view) {
  clock_ = keys_.empty() ? 0.0 : keys_.back().t + kKeySeconds;
  samples_.assign(1, keyOf(view, clock_));
  recording_ = true;
}

void PathRecorder::record(const View& view, double seconds) {
  if (!recording_) return;
  clock_ += seconds;
  if (clock_ - samples_.back().t < kLeastSeconds) return;
  samples_.push_back(keyOf(view, clock_));
}

void PathRecorder::endRecording() {
  if (!recording_) return;
  recording_ = false;
  const bool moved = std::any_of(samples_.begin(), samples_.end(), [this](const CameraKey& key) {
    return key.eye != samples_.front().eye || key.target != samples_.front().target;
  });
  if (!moved) samples_.resize(1);
  const std::vector<CameraKey> keys = thinned(samples_, kTolerance);
  keys_.insert(keys_.end(), keys.begin(), keys.end());
  samples_.clear();
}

CameraPath PathRecorder::path(double fovY, double fps) const {
  CameraPath path;
  path.keys = keys_;
  path.fovY = fovY;
  path.fps = fps;
  return path;
}

}  // namespace strata
