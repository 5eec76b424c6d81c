// Profiles read from a store against all its points looked at one by one.
#include "viewer/tools/profile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <cstdio>
#include <map>
#include <random>
#include <set>

#include "tests/support/lod_store.h"
#include "viewer/tools/profile_picture.h"

namespace strata {
namespace {

using Point = std::complex<double>;

/// Along and across by turning each segment onto the real axis.
std::optional<SlabPlace> oraclePlace(const std::vector<Point>& line, double width, Point p) {
  double best = 1e300, begin = 0.0;
  std::optional<SlabPlace> place;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const double length = std::abs(line[i + 1] - line[i]);
    const Point turned = (p - line[i]) * std::conj(line[i + 1] - line[i]) / length;
    const double overshoot = turned.real() < 0.0 ? turned.real() : std::max(turned.real() - length, 0.0);
    const double distance = std::hypot(overshoot, turned.imag());
    const bool pastEnd = (i == 0 && overshoot < 0.0) || (i + 2 == line.size() && overshoot > 0.0);
    if (distance < best) {
      best = distance;
      place.reset();
      if (!pastEnd && distance <= 0.5 * width)
        place = SlabPlace{begin + turned.real() - overshoot, turned.imag() < 0.0 ? -distance : distance};
      // Around a corner lies what the line turns away from.
      if (place && overshoot != 0.0) {
        const std::size_t corner = overshoot < 0.0 ? i : i + 1;
        const double turn = std::arg((line[corner + 1] - line[corner]) / (line[corner] - line[corner - 1]));
        place->across = turn < 0.0 ? distance : -distance;
      }
    }
    begin += length;
  }
  return place;
}

struct Found {
  SlabPlace place;
  int depth;
  std::uint32_t nodePoints;
};
using Id = std::tuple<int, std::uint32_t, std::uint32_t>;  // store, node, index

std::map<Id, Found> allInSlab(const std::vector<std::shared_ptr<const Store>>& stores, const ProfileSlab& slab) {
  std::vector<Point> line;
  for (const glm::dvec2& p : slab.line) line.emplace_back(p.x, p.y);
  std::map<Id, Found> found;
  for (std::size_t s = 0; s < stores.size(); ++s)
    for (std::uint32_t n = 0; n < stores[s]->hierarchy().nodes.size(); ++n) {
      const NodePoints points = readAll(*stores[s], n);
      const StoreGrid& grid = stores[s]->info().grid;
      for (std::uint32_t i = 0; i < points.count(); ++i) {
        const Point p(grid.offset.x + grid.scale.x * static_cast<double>(points.grid[0][i]),
                      grid.offset.y + grid.scale.y * static_cast<double>(points.grid[1][i]));
        if (const auto place = oraclePlace(line, slab.width, p))
          found[{static_cast<int>(s), n, i}] = {*place, NodeKey{stores[s]->hierarchy().nodes[n].key}.level(),
                                                static_cast<std::uint32_t>(points.count())};
      }
    }
  return found;
}

/// What of them a limit leaves: whole depths, and the largest share 1/2^k of the next one that fits.
std::set<Id> limited(const std::map<Id, Found>& all, const ProfileOptions& options) {
  std::set<Id> kept;
  for (int depth = 0; depth <= options.depth && depth < 21; ++depth)
    for (double share = 1.0;; share *= 0.5) {
      std::set<Id> here;
      for (const auto& [id, f] : all)
        if (f.depth == depth && std::get<2>(id) < static_cast<std::uint32_t>(share * f.nodePoints)) here.insert(id);
      if (kept.size() + here.size() > options.mostPoints) continue;
      kept.insert(here.begin(), here.end());
      if (share < 1.0) return kept;
      break;
    }
  return kept;
}

class ProfileOfStores : public testing::Test {
 protected:
  const test::Terrain terrain_ = test::makeTerrain({.levels = 4, .side = 12}, true);
  const std::vector<std::shared_ptr<const Store>> stores_{test::makeStore(terrain_)};

  ProfileSlab randomSlab(std::mt19937_64& random) const {
    const Box cube = terrain_.info.rootCube();
    std::uniform_real_distribution<double> share(-0.1, 1.1);
    ProfileSlab slab;
    const std::size_t corners = 2 + random() % 4;
    for (std::size_t i = 0; i < corners; ++i)
      slab.line.push_back(glm::dvec2(cube.min) + glm::dvec2(cube.size()) * glm::dvec2(share(random), share(random)));
    slab.width = std::pow(10.0, std::uniform_real_distribution<double>(-1.0, 2.3)(random));
    return slab;
  }
};

TEST_F(ProfileOfStores, HoldExactlyThePointsThatLieInTheSlab) {
  std::mt19937_64 random(11);
  std::size_t points = 0;
  for (int i = 0; i < 60; ++i) {
    const ProfileSlab slab = randomSlab(random);
    const auto all = allInSlab(stores_, slab);
    const Profile profile = readProfile(stores_, slab, {}, {});
    EXPECT_TRUE(profile.whole);
    ASSERT_EQ(profile.points.size(), all.size());
    double last = 0.0;
    for (const ProfilePoint& p : profile.points) {
      const auto found = all.find({p.store, p.node, p.index});
      ASSERT_NE(found, all.end());
      EXPECT_NEAR(p.along, found->second.place.along, 1e-6);
      EXPECT_NEAR(p.across, found->second.place.across, 1e-6);
      EXPECT_GE(p.along, last);
      last = p.along;
    }
    points += all.size();
  }
  EXPECT_GT(points, 10'000u);
}

TEST_F(ProfileOfStores, KeepToTheLimitByTheLargestEvenShareThatFits) {
  std::mt19937_64 random(12);
  int cut = 0;
  for (int i = 0; i < 40; ++i) {
    ProfileSlab slab = randomSlab(random);
    slab.width = 60.0;
    const auto all = allInSlab(stores_, slab);
    ProfileOptions options;
    options.mostPoints = 1 + random() % 500;
    options.depth = static_cast<int>(random() % 5);
    const Profile profile = readProfile(stores_, slab, options, {});
    EXPECT_LE(profile.points.size(), options.mostPoints);
    std::set<Id> got;
    for (const ProfilePoint& p : profile.points) got.insert({p.store, p.node, p.index});
    EXPECT_EQ(got, limited(all, options));
    EXPECT_EQ(profile.whole, got.size() == all.size()) << profileText(profile);
    cut += profile.share < 1.0 ? 1 : 0;
  }
  EXPECT_GT(cut, 10);
}

TEST_F(ProfileOfStores, GoThroughSeveralStoresAndSayWhatCouldNotBeRead) {
  ProfileSlab slab;
  const Box cube = terrain_.info.rootCube();
  slab.line = {glm::dvec2(cube.min), glm::dvec2(cube.max)};
  slab.width = 40.0;
  const std::size_t one = readProfile(stores_, slab, {}, {}).points.size();
  EXPECT_EQ(readProfile(std::vector{stores_[0], stores_[0]}, slab, {}, {}).points.size(), 2 * one);
  const auto broken = test::makeStore(terrain_, [](std::uint64_t call) {
    if (call % 3 == 2) throw Error("points.bin", "the disk is gone");
  });
  const Profile rest = readProfile(std::vector{broken}, slab, {}, {});
  EXPECT_GT(rest.nodesFailed, 0u);
  EXPECT_FALSE(rest.whole);
  EXPECT_GT(rest.points.size(), one / 4);
  EXPECT_LT(rest.points.size(), one);
  EXPECT_NE(rest.failure.find("the disk is gone"), std::string::npos);
  EXPECT_NE(profileText(rest).find("could not be read"), std::string::npos);
}

TEST_F(ProfileOfStores, EndAtOnceWhenStopped) {
  std::stop_source stop;
  stop.request_stop();
  ProfileSlab slab{{glm::dvec2(0.0), glm::dvec2(1.0)}, 1.0};
  const Profile profile = readProfile(stores_, slab, {}, stop.get_token());
  EXPECT_TRUE(profile.points.empty());
  EXPECT_FALSE(profile.whole);
}

TEST_F(ProfileOfStores, AreWrittenALineAPointOfTheClassesAskedFor) {
  ProfileSlab slab{{glm::dvec2(terrain_.info.rootCube().min), glm::dvec2(terrain_.info.rootCube().max)}, 10.0};
  const Profile profile = readProfile(stores_, slab, {}, {});
  ASSERT_FALSE(profile.points.empty());
  const auto lines = [](const std::string& csv) { return std::count(csv.begin(), csv.end(), '\n'); };
  const std::string csv = profileCsv(profile, std::bitset<256>().set());
  EXPECT_EQ(lines(csv), static_cast<std::ptrdiff_t>(profile.points.size()) + 1);
  EXPECT_EQ(lines(profileCsv(profile, std::bitset<256>())), 1);
  const std::string second = csv.substr(csv.find('\n') + 1);
  double along = -1.0, across = -1.0, x = 0.0, y = 0.0, z = 0.0;
  ASSERT_EQ(std::sscanf(second.c_str(), "%lf,%lf,%lf,%lf,%lf", &along, &across, &x, &y, &z), 5);
  EXPECT_NEAR(x, profile.points[0].position.x, 1e-9);
  EXPECT_NEAR(z, profile.points[0].position.z, 1e-9);
  EXPECT_NEAR(along, profile.points[0].along, 1e-4);
}

TEST_F(ProfileOfStores, ArePicturedWithEveryPointUnderItsOwnPixelOrOneNearerToTheViewer) {
  ProfileSlab slab{{glm::dvec2(terrain_.info.rootCube().min), glm::dvec2(terrain_.info.rootCube().max)}, 30.0};
  const Profile profile = readProfile(stores_, slab, {}, {});
  DrawOptions options;
  Picture frame;
  std::mt19937 random(5);
  ProfileWindow window = fitProfile(profile, 300, 120, 10.0);
  for (int i = 0; i < 20; ++i) {
    drawProfile(profile, window, options, frame);
    std::size_t drawn = 0;
    for (const ProfilePoint& p : profile.points) {
      const glm::dvec2 pixel = pixelOfProfile(window, {p.along, p.position.z});
      if (pixel.x < 0.0 || pixel.y < 0.0 || pixel.x >= window.width || pixel.y >= window.height) continue;
      ++drawn;
      const auto id = profilePointAt(frame, pixel, 0);
      ASSERT_TRUE(id);
      EXPECT_LE(profile.points[*id].across, p.across + 1e-5);
    }
    EXPECT_TRUE(i > 0 || drawn == profile.points.size());
    const glm::dvec2 at(static_cast<double>(random() % 300), static_cast<double>(random() % 120));
    const glm::dvec2 before = metresAt(window, at);
    window = zoomedProfile(window, at, i % 2 == 0 ? 0.7 : 1.2);
    EXPECT_LT(glm::distance(metresAt(window, at), before), 1e-6);
    window = pannedProfile(window, {3.0, -2.0});
  }
}

TEST(Profile, TheSlabEndsSquareAndGoesRoundItsCorners) {
  const ProfileSlab slab{{{0.0, 0.0}, {10.0, 0.0}, {10.0, 10.0}}, 2.0};
  EXPECT_FALSE(placeInSlab(slab, {-0.1, 0.0}));
  EXPECT_FALSE(placeInSlab(slab, {10.0, 10.1}));
  EXPECT_FALSE(placeInSlab(slab, {5.0, 1.1}));
  EXPECT_NEAR(placeInSlab(slab, {5.0, 1.0})->across, 1.0, 1e-12);
  EXPECT_NEAR(placeInSlab(slab, {5.0, -0.5})->across, -0.5, 1e-12);
  EXPECT_NEAR(placeInSlab(slab, {10.6, -0.6})->along, 10.0, 1e-12);  // outside of the corner
  EXPECT_NEAR(placeInSlab(slab, {10.5, 4.0})->along, 14.0, 1e-12);
}

}  // namespace
}  // namespace strata
