#include "viewer/camera/path_recorder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace strata {
namespace {

/// A hand's flight: an eye on a smooth curve through UTM coordinates that looks about, with a pause.
std::vector<CameraKey> flight(int frames, unsigned seed, double scale) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.2, 1.0);
  const double a = unit(random), b = unit(random), c = unit(random);
  std::vector<CameraKey> keys;
  for (int i = 0; i < frames; ++i) {
    CameraKey key;
    key.t = 0.02 + i / 60.0;
    const double u = key.t < 2.0 ? key.t : std::max(2.0, key.t - 1.0);
    key.eye = glm::dvec3(630000.0, 4850000.0, 100.0) +
              scale * glm::dvec3(std::sin(a * u), std::cos(b * u), 0.3 * std::sin(c * u));
    key.target = key.eye + 0.5 * scale * glm::dvec3(std::cos(b * u), std::sin(c * u), -0.4);
    keys.push_back(key);
  }
  return keys;
}

TEST(PathRecorder, AThinnedPathPassesEverySampleWithinTheToleranceOnFewKeys) {
  for (const double scale : {0.1, 10.0, 1e5})
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const std::vector<CameraKey> samples = flight(600, seed, scale);
      CameraPath path;
      path.keys = thinned(samples, 0.01);
      EXPECT_EQ(path.keys.front(), samples.front());
      EXPECT_EQ(path.keys.back(), samples.back());
      EXPECT_LT(path.keys.size(), 60u);
      for (const CameraKey& sample : samples) {
        const View view = viewAt(path, sample.t, 100, 100);
        const double away = glm::distance(sample.eye, sample.target);
        EXPECT_LE(glm::distance(view.eye, sample.eye), 0.01 * away * 1.0001);
        EXPECT_LE(glm::distance(view.target, sample.target), 0.01 * away * 1.0001);
      }
    }
}

TEST(PathRecorder, AStraightFlightAtOneSpeedIsTwoKeys) {
  std::vector<CameraKey> samples;
  for (int i = 0; i < 200; ++i) {
    CameraKey key;
    key.t = i / 30.0;
    key.eye = {100.0 + i, 5.0, 3.0};
    key.target = key.eye + glm::dvec3(10.0, 0.0, 0.0);
    samples.push_back(key);
  }
  EXPECT_EQ(thinned(samples, 0.001).size(), 2u);
}

TEST(PathRecorder, WhatWasFlownIsWhatIsPlayedWhateverTheFrameRate) {
  for (const double rate : {12.0, 60.0, 500.0}) {
    PathRecorder recorder;
    View view;
    view.target = {0.0, 0.0, 0.0};
    const auto at = [&](double t) {
      view.eye = {20.0 * std::cos(t), 20.0 * std::sin(t), 5.0 + t};
      return view;
    };
    recorder.beginRecording(at(0.0));
    for (int i = 1; i <= static_cast<int>(5.0 * rate); ++i) recorder.record(at(i / rate), 1.0 / rate);
    recorder.endRecording();
    const CameraPath path = recorder.path(view.fovY, 30.0);
    EXPECT_NEAR(path.duration(), 5.0, 0.02);
    for (double t = 0.0; t < 4.9; t += 0.1)
      EXPECT_LT(glm::distance(viewAt(path, t, 10, 10).eye, at(t).eye), 0.02 * 21.0) << rate;
    EXPECT_EQ(parseCameraPath("x", cameraPathJson(path)).keys, path.keys);
  }
}

TEST(PathRecorder, ARecordingGoesBehindTheKeysThatAreThereAndWithoutMotionIsOneKey) {
  PathRecorder recorder;
  View view;
  recorder.addKey(view);
  recorder.beginRecording(view);
  for (int i = 0; i < 50; ++i) recorder.record(view, 0.02);
  EXPECT_TRUE(recorder.recording());
  recorder.endRecording();
  ASSERT_EQ(recorder.keys().size(), 2u);
  EXPECT_EQ(recorder.keys()[1].t, PathRecorder::kKeySeconds);
}

TEST(PathRecorder, KeysStayInOrderWhateverIsDoneToThem) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 3.0);
  PathRecorder recorder;
  View view;
  for (int round = 0; round < 2000; ++round) {
    const std::size_t index = recorder.keys().empty() ? 0 : random() % recorder.keys().size();
    view.eye = {unit(random), -5.0, unit(random)};
    switch (random() % 5) {
      case 0:
      case 1:
        recorder.addKey(view);
        break;
      case 2:
        recorder.removeKey(index);
        break;
      case 3:
        recorder.setStep(index, unit(random));
        break;
      default:
        recorder.replaceKey(index, view);
        break;
    }
    const auto& keys = recorder.keys();
    if (keys.empty()) continue;
    EXPECT_EQ(keys.front().t, 0.0);
    for (std::size_t i = 1; i < keys.size(); ++i) ASSERT_GT(keys[i].t, keys[i - 1].t);
    EXPECT_NO_THROW(parseCameraPath("x", cameraPathJson(recorder.path(1.0, 30.0))));
  }
}

TEST(PathRecorder, AKeyOfAViewWithoutPerspectiveShowsTheTargetAsLarge) {
  View flat;
  flat.eye = {0.0, -100.0, 0.0};
  flat.orthographic = true;
  flat.orthographicHeight = 10.0;
  PathRecorder recorder;
  recorder.addKey(flat);
  const View seen = viewAt(recorder.path(flat.fovY, 30.0), 0.0, 800, 600);
  EXPECT_NEAR(pixelsAt(seen, 1.0, glm::distance(seen.eye, seen.target)), 60.0, 1e-6);
}

}  // namespace
}  // namespace strata
