#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "viewer/camera/camera_control.h"
#include "viewer/camera/composition.h"
#include "viewer/camera/dense_surface.h"
#include "viewer/camera/path_maker.h"
#include "viewer/camera/stills.h"

namespace strata {
namespace {

/// A flat town at UTM coordinates: ground of 400 x 200 m with blocks of houses and streets between them.
ScanSample town() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 60000; ++i) {
    const double x = 400.0 * unit(random);
    const double y = 200.0 * unit(random);
    const bool house = std::fmod(x, 50.0) > 15.0 && std::fmod(y, 50.0) > 15.0;
    const double z = house ? 12.0 * std::pow(unit(random), 0.3) : 0.0;
    points.push_back({630000.0 + x, 4850000.0 + y, 100.0 + z});
  }
  return makeScanSample(std::move(points));
}

/// A sphere 2 m across.
ScanSample statue() {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 20000; ++i)
    points.push_back(glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))));
  return makeScanSample(std::move(points));
}

/// Floor, ceiling and four walls.
ScanSample room() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 30000; ++i) {
    glm::dvec3 p(unit(random), unit(random), unit(random));
    const int face = i % 6;
    p[face / 2] = face % 2;
    points.push_back(p * glm::dvec3(6.0, 5.0, 2.7));
  }
  return makeScanSample(std::move(points));
}

double shareInPicture(const ScanSample& scan, const View& view) {
  int seen = 0;
  for (const glm::dvec3& p : scan.points) {
    const glm::dvec2 pixel = pixelOf(view, p);
    seen +=
        depthOf(view, p) > 0.0 && pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x <= view.width && pixel.y <= view.height
            ? 1
            : 0;
  }
  return static_cast<double>(seen) / static_cast<double>(scan.points.size());
}

TEST(ScanSample, KnowsARoomFromATownAndAStatue) {
  EXPECT_TRUE(room().enclosed);
  EXPECT_FALSE(town().enclosed);
  EXPECT_FALSE(statue().enclosed);
}

TEST(ScanSample, LeavesAFarOutlierOutOfItsBounds) {
  std::vector<glm::dvec3> points = town().points;
  points.push_back({0.0, 0.0, 90000.0});
  EXPECT_LT(makeScanSample(points).diagonal(), 600.0);
}

TEST(ScanSample, SurvivesNoPointOnePointAndOneLine) {
  EXPECT_GT(makeScanSample({}).diagonal(), 0.0);
  EXPECT_GT(makeScanSample({{5.0, 5.0, 5.0}}).diagonal(), 0.0);
  const ScanSample line = makeScanSample({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}});
  for (const CameraPath& path : {orbitPath(line), flythroughPath(line), streetPath(line)})
    EXPECT_NO_THROW(parseCameraPath("p", cameraPathJson(path)));
}

TEST(Stills, AFittedViewHoldsAllAndTouchesTheEdge) {
  for (const ScanSample& scan : {town(), statue(), room()})
    for (double azimuth = 0.0; azimuth < 6.28; azimuth += 0.7) {
      const View view = fittedView(scan, lookingAt(azimuth, 0.5), 1920, 1080, 0.8);
      EXPECT_EQ(shareInPicture(scan, view), 1.0);
      View closer = view;
      closer.eye += 0.1 * (view.target - view.eye);
      EXPECT_LT(shareInPicture(scan, closer), 1.0);
    }
}

TEST(Stills, TheOverviewFillsThePictureWithAllOfTheScan) {
  for (const ScanSample& scan : {town(), statue()}) {
    const Still still = overviewStill(scan, 1920, 1080);
    EXPECT_EQ(shareInPicture(scan, still.view), 1.0);
    EXPECT_GT(compose(scan, still.view, still.subject).coverage, 0.25);
    EXPECT_GT(still.view.eye.z, scan.bounds.centre().z);
  }
}

TEST(Stills, TheOverviewOfARoomIsFromInside) {
  const ScanSample scan = room();
  EXPECT_TRUE(scan.bounds.contains(overviewStill(scan, 1920, 1080).view.eye));
}

TEST(Stills, PointsGetAsLargeAsTheirDistanceOnTheScreen) {
  Picture frame;
  frame.width = 240;
  frame.height = 240;
  frame.pointId.assign(240 * 240, Picture::kNoPoint);
  frame.depth.assign(240 * 240, INFINITY);
  for (std::size_t y = 0; y < 240; y += 4)
    for (std::size_t x = 0; x < 240; x += 4) {
      frame.pointId[y * 240 + x] = 1;
      frame.depth[y * 240 + x] = 10.0f;
    }
  View view;
  view.width = view.height = 240;
  EXPECT_NEAR(frontSpacing(frame, view).pixels, 4.0, 1e-9);
  // What shines through from behind does not count.
  for (std::size_t i = 0; i < frame.pointId.size(); i += 7)
    if (frame.pointId[i] == Picture::kNoPoint) {
      frame.pointId[i] = 2;
      frame.depth[i] = 20.0f;
    }
  EXPECT_NEAR(frontSpacing(frame, view).pixels, 4.0, 1e-9);
  EXPECT_NEAR(frontSpacing(frame, view).metres, 4.0 / pixelsAt(view, 1.0, 10.0), 1e-9);
  EXPECT_EQ(closedPointSize(0.0), 1);
  EXPECT_GT(closedPointMetres(0.5), 0.5f);
}

TEST(DensePlace, IsWhereTheSurfaceWasScannedDensely) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 4000; ++i) points.push_back({10.0 * unit(random), 10.0 * unit(random), 0.0});
  for (int i = 0; i < 20000; ++i) points.push_back({6.0 + 3.0 * unit(random), 2.0 + 3.0 * unit(random), 0.0});
  const DensePlace place = densestAmong(points, 0.25);
  EXPECT_GT(place.centre.x, 6.0);
  EXPECT_LT(place.centre.x, 9.0);
  EXPECT_GT(place.centre.y, 2.0);
  EXPECT_LT(place.centre.y, 5.0);
  EXPECT_NEAR(place.spacing, std::sqrt(9.0 / 20000.0), 0.01);
}

TEST(PathMaker, OrbitShowsNearlyAllOfTheScanAllTheWay) {
  for (const ScanSample& scan : {town(), statue()}) {
    const CameraPath path = orbitPath(scan);
    for (double t = 0.0; t <= path.duration(); t += 0.1) {
      const View view = viewAt(path, t, 1920, 1080);
      EXPECT_GT(shareInPicture(scan, view), 0.99) << t;
    }
    EXPECT_EQ(path.keys.front().eye, path.keys.back().eye);
  }
}

TEST(PathMaker, PathsOfAScanInOnePlaceCanBeFlown) {
  for (const glm::dvec3& place : {glm::dvec3(0.0), glm::dvec3(5.0, 5.0, 5.0), glm::dvec3(630000.0, 4850000.0, 100.0)})
    for (const std::size_t copies : {1u, 1000u}) {
      const ScanSample scan = makeScanSample(std::vector<glm::dvec3>(copies, place));
      for (const CameraPath& path : {orbitPath(scan), flythroughPath(scan), streetPath(scan)}) {
        const CameraPath read = parseCameraPath("p", cameraPathJson(path));
        for (const CameraKey& key : read.keys)
          EXPECT_LT(glm::distance(key.eye, place), 10.0) << key.eye.x << " " << key.eye.y << " " << key.eye.z;
      }
    }
}

TEST(PathMaker, FlythroughStaysAboveTheRoofsAndSeesTheTown) {
  const ScanSample scan = town();
  const CameraPath path = flythroughPath(scan);
  for (double t = 0.0; t <= path.duration(); t += 0.25) {
    const View view = viewAt(path, t, 1920, 1080);
    EXPECT_GT(view.eye.z, scan.bounds.max.z);
    EXPECT_GT(shareInPicture(scan, view), 0.02) << t;
  }
}

TEST(PathMaker, StreetWalksAtEyeHeightBetweenTheHouses) {
  const ScanSample scan = town();
  const CameraPath path = streetPath(scan);
  int inHouse = 0;
  int steps = 0;
  for (double t = 0.0; t <= path.duration(); t += 0.1, ++steps) {
    const glm::dvec3 eye = viewAt(path, t, 1920, 1080).eye;
    EXPECT_NEAR(eye.z, 101.7, 0.6);
    const double x = std::fmod(eye.x - 630000.0, 50.0);
    const double y = std::fmod(eye.y - 4850000.0, 50.0);
    inHouse += x > 17.0 && x < 48.0 && y > 17.0 && y < 48.0 ? 1 : 0;
  }
  EXPECT_LT(inHouse, steps / 10);
}

}  // namespace
}  // namespace strata
