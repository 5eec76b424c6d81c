#include "viewer/camera/camera_path.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>
#include <random>

#include "core/error.h"

namespace strata {
namespace {

CameraPath randomPath(unsigned seed, int keys) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-1000.0, 1000.0);
  std::uniform_real_distribution<double> step(0.1, 5.0);
  CameraPath path;
  double t = place(random) / 100.0;
  for (int i = 0; i < keys; ++i, t += step(random))
    path.keys.push_back({t,
                         {630000.0 + place(random), 4850000.0 + place(random), place(random)},
                         {630000.0 + place(random), 4850000.0 + place(random), place(random)},
                         {0.0, 0.0, 1.0}});
  return path;
}

std::string refusal(const std::string& json) {
  try {
    parseCameraPath("path.json", json);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

std::string withKeys(const std::string& keys) { return "{\"fps\":30,\"fov_y\":60,\"keys\":[" + keys + "]}"; }

TEST(CameraPath, PassesThroughEveryKey) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const CameraPath path = randomPath(seed, 1 + static_cast<int>(seed % 7));
    for (const CameraKey& key : path.keys) {
      const View view = viewAt(path, key.t, 640, 480);
      EXPECT_LT(glm::distance(view.eye, key.eye), 1e-8) << seed;
      EXPECT_LT(glm::distance(view.target, key.target), 1e-8) << seed;
    }
  }
}

TEST(CameraPath, HasNoJumpInPlaceOrVelocityAtAKey) {
  const CameraPath path = randomPath(7, 6);
  const double h = 1e-5;
  for (std::size_t i = 1; i + 1 < path.keys.size(); ++i) {
    const double t = path.keys[i].t;
    const glm::dvec3 here = viewAt(path, t, 1, 1).eye;
    const glm::dvec3 before = (here - viewAt(path, t - h, 1, 1).eye) / h;
    const glm::dvec3 after = (viewAt(path, t + h, 1, 1).eye - here) / h;
    EXPECT_LT(glm::distance(before, after), 1e-2 * (1.0 + glm::length(before)));
  }
}

TEST(CameraPath, MovesAtConstantSpeedThroughKeysSetAtConstantSpeed) {
  CameraPath path;
  for (const double t : {0.0, 1.0, 1.5, 4.0, 4.25})  // uneven keys on one straight, even motion
    path.keys.push_back({t, {3.0 * t, -2.0 * t, t}, {3.0 * t, -2.0 * t + 10.0, t}, {0.0, 0.0, 1.0}});
  for (double t = 0.0; t <= 4.25; t += 0.05)
    EXPECT_LT(glm::distance(viewAt(path, t, 1, 1).eye, glm::dvec3(3.0 * t, -2.0 * t, t)), 1e-12) << t;
}

TEST(CameraPath, StandsStillBetweenEqualKeys) {
  CameraPath path;
  path.keys = {{0.0, {1, 2, 3}, {4, 5, 6}, {0, 0, 1}}, {2.0, {1, 2, 3}, {4, 5, 6}, {0, 0, 1}}};
  EXPECT_EQ(viewAt(path, 1.3, 1, 1).eye, glm::dvec3(1, 2, 3));
}

TEST(CameraPath, ClosesALoopSmoothly) {
  CameraPath path;
  for (int i = 0; i <= 8; ++i) {
    const double angle = (i % 8) * std::numbers::pi / 4.0;
    path.keys.push_back({static_cast<double>(i), {std::cos(angle), std::sin(angle), 0.0}, {0, 0, 0}, {0, 0, 1}});
  }
  const double h = 1e-6;
  const glm::dvec3 start = (viewAt(path, h, 1, 1).eye - path.keys[0].eye) / h;
  const glm::dvec3 end = (path.keys[8].eye - viewAt(path, 8.0 - h, 1, 1).eye) / h;
  EXPECT_LT(glm::distance(start, end), 1e-4);
  for (double t = 0.0; t <= 8.0; t += 0.1) EXPECT_NEAR(glm::length(viewAt(path, t, 1, 1).eye), 1.0, 0.02);
}

TEST(CameraPath, HoldsTheEndsOutsideItsTime) {
  const CameraPath path = randomPath(3, 4);
  EXPECT_EQ(viewAt(path, path.keys.front().t - 5.0, 1, 1).eye, path.keys.front().eye);
  EXPECT_EQ(viewAt(path, path.keys.back().t + 5.0, 1, 1).eye, path.keys.back().eye);
}

TEST(CameraPath, CountsBothEndFrames) {
  CameraPath path;
  path.keys = {{2.0, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {4.0, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}}};
  EXPECT_EQ(path.frames(), 61);
  path.keys.pop_back();
  EXPECT_EQ(path.frames(), 1);
}

TEST(CameraPath, ComesBackFromItsJsonUnchanged) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    CameraPath path = randomPath(seed, 5);
    path.fps = 24.0;
    const CameraPath again = parseCameraPath("path.json", cameraPathJson(path));
    EXPECT_EQ(again.keys, path.keys);
    EXPECT_EQ(again.fps, path.fps);
    EXPECT_NEAR(again.fovY, path.fovY, 1e-15);
  }
}

TEST(CameraPath, TakesDefaultsForWhatMayBeAbsent) {
  const CameraPath path = parseCameraPath("p", R"({"keys":[{"t":0,"eye":[0,0,1],"target":[1,0,1]}]})");
  EXPECT_EQ(path.fps, 30.0);
  EXPECT_NEAR(path.fovY, std::numbers::pi / 3.0, 1e-15);
  EXPECT_EQ(path.keys[0].up, glm::dvec3(0, 0, 1));
}

TEST(CameraPath, SaysWhatIsWrongAndWhere) {
  const std::string key = R"({"t":2,"eye":[0,0,0],"target":[1,0,0]})";
  EXPECT_EQ(refusal("{"), "path.json: is no JSON, at byte 2");
  EXPECT_EQ(refusal(withKeys(R"({"t":NaN,"eye":[0,0,0],"target":[1,0,0]})")).substr(0, 33),
            "path.json: is no JSON, at byte 35");
  EXPECT_EQ(refusal(withKeys(R"({"t":0,"eye":[0,0,1e999],"target":[1,0,0]})")),
            "path.json: holds a number too large for a double");
  EXPECT_EQ(refusal("[]"), "path.json: is no camera path, found JSON of type array");
  EXPECT_EQ(refusal("{}"), "path.json: keys is missing or empty (expected a list of at least one key)");
  EXPECT_EQ(refusal(withKeys("")), "path.json: keys is missing or empty (expected a list of at least one key)");
  EXPECT_EQ(refusal(withKeys(key + "," + R"({"t":1,"eye":[0,0,0],"target":[1,0,0]})")),
            "path.json: key 2: t 1.0 is not after 2.0");
  EXPECT_EQ(refusal(withKeys(key + "," + key)), "path.json: key 2: t 2.0 is not after 2.0");
  EXPECT_EQ(refusal(withKeys("7")), "path.json: key 1: found 7 (expected an object)");
  EXPECT_EQ(refusal(withKeys(R"({"eye":[0,0,0],"target":[1,0,0]})")), "path.json: key 1: t is missing or no number");
  EXPECT_EQ(refusal(withKeys(R"({"t":0,"target":[1,0,0]})")), "path.json: key 1: eye is missing");
  EXPECT_EQ(refusal(withKeys(R"({"t":0,"eye":[0,0],"target":[1,0,0]})")),
            "path.json: key 1: eye, found [0,0] (expected three numbers)");
  EXPECT_EQ(refusal(withKeys(R"({"t":0,"eye":[1,0,0],"target":[1,0,0]})")),
            "path.json: key 1: eye and target are the same point");
  EXPECT_EQ(refusal(R"({"fps":0,"keys":[)" + key + "]}"), "path.json: fps, found 0.0 (expected above 0, at most 1000)");
  EXPECT_EQ(refusal(R"({"fov_y":190,"keys":[)" + key + "]}"),
            "path.json: fov_y, found 190 (expected 1 to 170 degrees)");
  EXPECT_EQ(refusal(R"({"fps":"x","keys":[)" + key + "]}"), "path.json: fps is no number, found \"x\"");
}

TEST(CameraPath, RefusesATimeThatWouldNeverEnd) {
  EXPECT_NE(refusal(withKeys(R"({"t":0,"eye":[0,0,0],"target":[1,0,0]},{"t":1e300,"eye":[0,0,0],"target":[1,0,0]})"))
                .find("too long"),
            std::string::npos);
  EXPECT_NE(
      refusal(withKeys(R"({"t":-1e308,"eye":[0,0,0],"target":[1,0,0]},{"t":1e308,"eye":[0,0,0],"target":[1,0,0]})"))
          .find("too long, found inf frames"),
      std::string::npos);
}

TEST(CameraPath, RefusesAFileWithoutEnd) {
  if (!std::filesystem::exists("/dev/zero")) GTEST_SKIP() << "no /dev/zero here";
  EXPECT_THROW(readCameraPath("/dev/zero"), Error);
}

TEST(CameraPath, NamesAFileThatIsNotThere) {
  try {
    readCameraPath("/nowhere/path.json");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()), "/nowhere/path.json: opening: No such file or directory");
  }
}

TEST(CameraPath, ACutHoldsTheCameraStillAndThenJumps) {
  CameraPath path = randomPath(11, 6);
  path.keys[3].cut = true;
  const CameraKey& before = path.keys[2];
  const CameraKey& cut = path.keys[3];
  for (const double u : {0.0, 0.25, 0.999}) {
    const View view = viewAt(path, before.t + u * (cut.t - before.t), 1, 1);
    EXPECT_EQ(view.eye, before.eye);
    EXPECT_EQ(view.target, before.target);
  }
  EXPECT_LT(glm::distance(viewAt(path, cut.t, 1, 1).eye, cut.eye), 1e-8);
}

TEST(CameraPath, KeysBeyondACutDoNotBendTheCurveBeforeIt) {
  CameraPath path = randomPath(12, 7);
  path.keys[4].cut = true;
  const View here = viewAt(path, 0.5 * (path.keys[2].t + path.keys[3].t), 1, 1);
  for (std::size_t i = 4; i < path.keys.size(); ++i) path.keys[i].eye += glm::dvec3(500.0, -300.0, 70.0);
  EXPECT_EQ(viewAt(path, 0.5 * (path.keys[2].t + path.keys[3].t), 1, 1).eye, here.eye);
}

TEST(PathClock, AtConstantSpeedEqualTimesAreEqualLengths) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    CameraPath path = randomPath(seed, 5);
    path.speed = PathSpeed::constant;
    const PathClock clock(path);
    const auto eyeAt = [&](double t) { return viewAt(path, clock.keyTime(t), 1, 1).eye; };
    // Lengths over a hundredth of the path, each in small steps: chords of a curve are shorter than the curve.
    std::vector<double> lengths;
    for (int i = 0; i < 100; ++i) {
      double length = 0.0;
      for (int s = 0; s < 50; ++s) {
        const double t = path.keys.front().t + path.duration() * (i * 50 + s) / 5000.0;
        length += glm::distance(eyeAt(t), eyeAt(t + path.duration() / 5000.0));
      }
      lengths.push_back(length);
    }
    const auto [least, most] = std::minmax_element(lengths.begin(), lengths.end());
    EXPECT_LT(*most / *least, 1.02) << seed;
  }
}

TEST(PathClock, GoesBothWaysAndIsTheSameForAKeyedPath) {
  CameraPath path = randomPath(3, 6);
  path.keys[3].cut = true;
  EXPECT_EQ(PathClock(path).keyTime(path.keys[2].t), path.keys[2].t);
  path.speed = PathSpeed::constant;
  const PathClock clock(path);
  for (int i = 0; i <= 100; ++i) {
    // Between the key before the cut and the cut the camera stands still.
    const double t = path.keys.front().t + path.duration() * i / 100.0;
    if (t > path.keys[2].t && t < path.keys[3].t) continue;
    EXPECT_NEAR(clock.pathTime(clock.keyTime(t)), t, 1e-6);
  }
  EXPECT_NEAR(clock.keyTime(path.keys[3].t), path.keys[3].t, 1e-9);
}

TEST(PathClock, ACameraThatOnlyTurnsKeepsTheKeysTimes) {
  CameraPath path = randomPath(5, 4);
  path.speed = PathSpeed::constant;
  for (CameraKey& key : path.keys) key.eye = {1.0, 2.0, 3.0};
  const double t = 0.3 * path.keys[0].t + 0.7 * path.keys[1].t;
  EXPECT_NEAR(PathClock(path).keyTime(t), t, 1e-9);
}

TEST(CameraPath, KnowsTheFramesOfItsMarksAndCuts) {
  CameraPath path =
      parseCameraPath("p", withKeys("{\"t\":0,\"eye\":[0,0,0],\"target\":[1,0,0],\"mark\":true},"
                                    "{\"t\":1,\"eye\":[1,0,0],\"target\":[2,0,0]},"
                                    "{\"t\":1.49,\"eye\":[9,0,0],\"target\":[8,0,0],\"cut\":true,\"mark\":true}"));
  EXPECT_EQ(markedFrames(path), (std::vector<int>{0, 44}));
  EXPECT_EQ(cutFrames(path), (std::vector<int>{44}));
  path.fps = 100.0;
  EXPECT_EQ(cutFrames(path), (std::vector<int>{149}));
}

TEST(CameraPath, SpeedCutsAndMarksSurviveTheFile) {
  CameraPath path = randomPath(2, 4);
  path.speed = PathSpeed::constant;
  path.keys[2].cut = true;
  path.keys[3].mark = true;
  const CameraPath again = parseCameraPath("p", cameraPathJson(path));
  EXPECT_EQ(again.speed, PathSpeed::constant);
  EXPECT_EQ(again.keys, path.keys);
  EXPECT_NE(refusal("{\"speed\":\"fast\",\"keys\":[{\"t\":0,\"eye\":[0,0,0],\"target\":[1,0,0]}]}").find("speed"),
            std::string::npos);
  EXPECT_NE(refusal(withKeys("{\"t\":0,\"eye\":[0,0,0],\"target\":[1,0,0],\"cut\":1}")).find("cut"), std::string::npos);
}

}  // namespace
}  // namespace strata
