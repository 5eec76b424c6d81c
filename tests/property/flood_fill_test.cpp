// Hole filling by jump flooding. Its searches are compared with looking at every seed; then come what it fills and what
// it leaves open.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "render/create_rasterizer.h"
#include "render/flood/flood_fill.h"
#include "render/flood/flood_search.h"
#include "tests/support/fill_judge.h"
#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

constexpr glm::dvec3 kUtm(456789.0, 5412345.0, 300.0);

const ThreadPool& pool() {
  static const ThreadPool two(2);
  return two;
}

/// Seeds in `share` of the pixels, on one or two planes ahead, as far apart as the pixels.
FloodSeeds randomSeeds(int width, int height, double share, int planes, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution stays(share);
  FloodSeeds seeds;
  seeds.width = width;
  seeds.height = height;
  seeds.lens = {false, 0.5f, 0.0f, 0.0f};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float depth = 1000.0f + 1000.0f * static_cast<float>(random() % static_cast<unsigned>(planes));
      seeds.at.push_back(kNoPixel);
      seeds.points.push_back({});
      if (!stays(random)) continue;
      const std::uint32_t within = random() % 4u;
      seeds.at.back() =
          floodPixel(static_cast<std::uint32_t>(2 * x) + within % 2u, static_cast<std::uint32_t>(2 * y) + within / 2u);
      seeds.points.back() = {depth, 40.0f};
    }
  return seeds;
}

/// All seeds of a half picture.
std::vector<FloodPixel> seedsOf(const FloodSeeds& seeds) {
  std::vector<FloodPixel> all;
  for (const FloodPixel seed : seeds.at)
    if (seed != kNoPixel) all.push_back(seed);
  return all;
}

int distance2(FloodPixel seed, int x, int y) {
  const int dx = pixelColumn(seed) / 2 - x, dy = pixelRow(seed) / 2 - y;
  return dx * dx + dy * dy;
}

float metresApart(const FloodSeeds& seeds, FloodPixel a, FloodPixel b) {
  return glm::length(seeds.position(a) - seeds.position(b));
}

FloodSettings jumpsOf32() {
  FloodSettings settings;
  settings.firstStep = 32;
  return settings;
}

TEST(FloodLayers, HoldTheSeedOfEachPlaneThatIsClosestToThePixel) {
  for (const double share : {0.3, 0.05, 0.01}) {
    const FloodSeeds seeds = randomSeeds(120, 90, share, 2, 7);
    const std::vector<FloodPixel> all = seedsOf(seeds);
    const auto layers = findLayers(seeds, jumpsOf32(), pool());
    std::size_t wanted = 0, found = 0;
    for (int y = 0; y < seeds.height; ++y)
      for (int x = 0; x < seeds.width; ++x)
        for (const float plane : {1000.0f, 2000.0f}) {
          const auto nearest = [&](const auto& some) {
            int least = 35 * 35;  // within the reach, with room
            for (const FloodPixel s : some)
              if (s != kNoPixel && seeds.points[seeds.index(s)].depth == plane)
                least = std::min(least, distance2(s, x, y));
            return least;
          };
          const int truth = nearest(all);
          if (truth == 35 * 35) continue;
          ++wanted;
          found += nearest(layers[static_cast<std::size_t>(y * seeds.width + x)]) == truth;
        }
    EXPECT_GE(static_cast<double>(found), 0.98 * static_cast<double>(wanted)) << "share " << share;
  }
}

TEST(FloodLayers, KeepASparseForegroundInFrontOfADenseBackground) {
  FloodSeeds seeds = randomSeeds(120, 90, 0.5, 1, 3);
  std::mt19937 random(5);
  for (FloodPoint& place : seeds.points) place.depth = random() % 50 == 0 ? 1000.0f : 2000.0f;
  const auto layers = findLayers(seeds, jumpsOf32(), pool());
  std::size_t with = 0;
  for (const FloodLayers& here : layers)
    with += std::any_of(here.begin(), here.end(),
                        [&](FloodPixel s) { return s != kNoPixel && seeds.points[seeds.index(s)].depth == 1000.0f; });
  EXPECT_GE(static_cast<double>(with), 0.999 * static_cast<double>(layers.size()));
}

/// The share of the true neighbours that were found, and how much farther away the found ones are on average.
struct Recall {
  double found = 0.0, farther = 0.0;
};

Recall recallOf(const FloodSeeds& seeds, FloodSettings settings) {
  settings.firstStep = 32;
  const auto layers = findLayers(seeds, settings, pool());
  const auto neighbours = findNeighbours(seeds, layers, settings, pool());
  const std::vector<FloodPixel> all = seedsOf(seeds);
  double wanted = 0.0, found = 0.0, farther = 0.0;
  for (const FloodPixel s : all) {
    std::vector<float> truth[kFloodNeighbours];  // of each sector, or all in the first
    for (const FloodPixel other : all) {
      if (other == s || !sameLayer(seeds, s, other, settings)) continue;
      const int dx = pixelColumn(other) - pixelColumn(s), dy = pixelRow(other) - pixelRow(s);
      const int sector = floodSector(static_cast<float>(dx), static_cast<float>(dy));
      truth[settings.sectors ? sector : 0].push_back(metresApart(seeds, s, other));
    }
    for (auto& distances : truth) std::sort(distances.begin(), distances.end());
    for (std::size_t i = 0; i < kFloodNeighbours; ++i) {
      const std::vector<float>& distances = truth[settings.sectors ? i : 0];
      const std::size_t rank = settings.sectors ? 0 : i;
      if (rank >= distances.size() || (!settings.sectors && i >= 4)) continue;
      wanted += 1.0;
      if (neighbours[seeds.index(s)][i] == kNoPixel) continue;
      const float apart = metresApart(seeds, s, neighbours[seeds.index(s)][i]);
      found += apart <= 1.0001f * distances[rank] ? 1.0 : 0.0;
      farther += apart / distances[rank] - 1.0;
    }
  }
  return {found / wanted, farther / wanted};
}

TEST(FloodNeighbours, AreTheClosestOfEachSectorUpToATolerance) {
  for (const double share : {0.5, 0.1, 0.02}) {
    const Recall recall = recallOf(randomSeeds(100, 80, share, 1, 11), {});
    EXPECT_GE(recall.found, 0.9) << "share " << share;
    EXPECT_LE(recall.farther, 0.02) << "share " << share;
  }
}

TEST(FloodNeighbours, AreTheFourClosestUpToATolerance) {
  FloodSettings settings;
  settings.sectors = false;
  for (const double share : {0.5, 0.1, 0.02}) {
    const Recall recall = recallOf(randomSeeds(100, 80, share, 1, 11), settings);
    EXPECT_GE(recall.found, 0.95) << "share " << share;
    EXPECT_LE(recall.farther, 0.02) << "share " << share;
  }
}

TEST(FloodNeighbours, AreOfTheSamePlaneWhereTwoAreMixed) {
  const FloodSeeds seeds = randomSeeds(100, 80, 0.3, 2, 2);
  const auto neighbours = findNeighbours(seeds, findLayers(seeds, {}, pool()), {}, pool());
  for (const FloodPixel s : seedsOf(seeds))
    for (const FloodPixel other : neighbours[seeds.index(s)])
      if (other != kNoPixel) {
        ASSERT_EQ(seeds.points[seeds.index(other)].depth, seeds.points[seeds.index(s)].depth);
      }
}

/// Points that have normals, all facing one of two ways.
TEST(FloodNeighbours, HaveNormalsThatAreAlike) {
  FloodSeeds seeds = randomSeeds(100, 80, 0.3, 1, 2);
  std::mt19937 random(9);
  const std::uint32_t ways[] = {packFloodNormal({0.0f, 0.0f, -1.0f}), packFloodNormal({0.8f, 0.6f, 0.0f})};
  for (std::size_t i = 0; i < seeds.at.size(); ++i) seeds.normals.push_back(ways[random() % 2]);
  const auto neighbours = findNeighbours(seeds, findLayers(seeds, {}, pool()), {}, pool());
  std::size_t found = 0;
  for (const FloodPixel s : seedsOf(seeds))
    for (const FloodPixel other : neighbours[seeds.index(s)])
      if (other != kNoPixel) {
        ++found;
        ASSERT_EQ(seeds.normals[seeds.index(other)], seeds.normals[seeds.index(s)]);
      }
  EXPECT_GT(found, 5 * seedsOf(seeds).size());
}

TEST(FloodSeeds, KeepNormalsToAThousandth) {
  std::mt19937 random(1);
  std::normal_distribution<float> part;
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 normal = glm::normalize(glm::vec3(part(random), part(random), part(random)));
    EXPECT_LT(glm::length(unpackFloodNormal(packFloodNormal(normal)) - normal), 2e-3f);
  }
  EXPECT_EQ(unpackFloodNormal(packFloodNormal(glm::vec3(0.0f))), glm::vec3(0.0f));
}

/// Points on the plane y = `distance`, one in each cell of `spacing` metres over [-half, half] in x and z, where
/// keep(x, z) is true.
template <typename Keep>
std::shared_ptr<const NodeData> wall(int number, double distance, double half, double spacing, Keep keep) {
  std::mt19937 random(static_cast<std::uint32_t>(number));
  std::uniform_real_distribution<double> within(0.0, 1.0);
  std::vector<glm::dvec3> points;
  for (double x = -half; x < half; x += spacing)
    for (double z = -half; z < half; z += spacing) {
      const glm::dvec3 p(x + within(random) * spacing, distance, z + within(random) * spacing);
      if (keep(p.x, p.z)) points.push_back(kUtm + p);
    }
  std::shuffle(points.begin(), points.end(), random);
  auto node = std::make_shared<NodeData>(*test::makeNode(NodeKey().child(number), points, 0.001));
  node->spacing = static_cast<float>(spacing);
  return node;
}

View ahead(int width = 300, int height = 200) {
  View view;
  view.eye = kUtm;
  view.target = kUtm + glm::dvec3(0.0, 1.0, 0.0);
  view.fovY = 1.0;
  view.width = width;
  view.height = height;
  return view;
}

Picture drawn(const RenderList& list, const View& view, bool jumpFlood, int pointSize = 1) {
  DrawOptions options;
  options.pointSize = pointSize;
  options.jumpFlood = jumpFlood;
  Picture picture;
  createRasterizer(Backend::cpu, {}, nullptr)->draw(list, view, options, picture);
  return picture;
}

constexpr auto kEverywhere = [](double, double) { return true; };

/// x and z of a pixel's middle on the plane y = `distance`.
glm::dvec2 onWall(const View& view, std::size_t pixel, double distance) {
  const double perPixel = distance / pixelsAt(view, 1.0, 1.0);
  const auto x = static_cast<double>(pixel % static_cast<std::size_t>(view.width)),
             y = static_cast<double>(pixel / static_cast<std::size_t>(view.width));
  return {(x + 0.5 - 0.5 * view.width) * perPixel, (0.5 * view.height - y - 0.5) * perPixel};
}

TEST(FloodFill, ClosesASparseWall) {
  const RenderList list = test::makeList({wall(1, 10.0, 12.0, 0.35, kEverywhere)});  // 6 pixels apart
  const Picture picture = drawn(list, ahead(), true);
  std::size_t open = 0;
  for (const float depth : picture.depth) open += std::abs(depth - 10.0f) > 0.05f;
  EXPECT_LE(open, picture.depth.size() / 100);
}

/// Puts points onto a lattice with gaps, as coarse positions do to a scan that is finer than the pixels.
TEST(FloodFill, ClosesTheGapsBetweenPixelsWhereTheScanIsFinerThanThem) {
  const auto lattice = std::make_shared<NodeData>(*wall(1, 10.0, 12.0, 0.1, kEverywhere));  // 1.7 pixels apart
  lattice->spacing = 0.025f;
  const RenderList list = test::makeList({lattice});
  const Picture before = drawn(list, ahead(), false), after = drawn(list, ahead(), true);
  const auto open = [](const Picture& f) { return std::count(f.pointId.begin(), f.pointId.end(), Picture::kNoPoint); };
  EXPECT_GT(open(before), static_cast<std::ptrdiff_t>(before.pointId.size() / 4));
  EXPECT_LT(open(after), static_cast<std::ptrdiff_t>(before.pointId.size() / 50));
}

TEST(FloodFill, LeavesAFullPictureAsItIs) {
  const RenderList walls = test::makeList({wall(1, 10.0, 12.0, 0.02, kEverywhere)});
  const Picture before = drawn(walls, ahead(), false), after = drawn(walls, ahead(), true);
  ASSERT_EQ(std::count(before.pointId.begin(), before.pointId.end(), Picture::kNoPoint), 0);
  EXPECT_EQ(before.colour, after.colour);
  EXPECT_EQ(before.depth, after.depth);
  EXPECT_EQ(before.pointId, after.pointId);
}

TEST(FloodFill, LeavesAWindowOpenWhateverLiesBehind) {
  const auto beside = [](double x, double z) { return std::abs(x) > 2.5 || std::abs(z) > 2.0; };
  const double spacing = 0.3;
  for (const bool background : {false, true}) {
    std::vector<std::shared_ptr<const NodeData>> nodes{wall(1, 10.0, 12.0, spacing, beside)};
    if (background) nodes.push_back(wall(2, 40.0, 45.0, 0.15, kEverywhere));
    const RenderList list = test::makeList(nodes);
    const View view = ahead();
    const Picture before = drawn(list, view, false), after = drawn(list, view, true);
    std::size_t window = 0, changed = 0, sparse = 0, open = 0;
    for (std::size_t i = 0; i < before.depth.size(); ++i) {
      const glm::dvec2 place = onWall(view, i, 10.0);
      if (std::abs(place.x) < 2.5 - 1.5 * spacing && std::abs(place.y) < 2.0 - 1.5 * spacing) {
        ++window;
        changed += after.depth[i] < 30.0f;
      } else if (beside(place.x, place.y)) {
        ++sparse;
        open += after.depth[i] > 10.1f;
      }
    }
    ASSERT_GT(window, 3000u);
    EXPECT_LE(changed, window / 500) << background;
    EXPECT_LE(open, sparse / 100) << background;
  }
}

/// Farias 2014, Fig. 5.18: columns of few points before a wall of many.
TEST(FloodFill, ClosesASparseForegroundButNotTheGapsBetweenItsParts) {
  const double spacing = 0.25;
  const auto columns = [](double x, double) { return std::abs(std::remainder(x, 4.0)) < 1.0; };
  const RenderList list =
      test::makeList({wall(1, 10.0, 12.0, spacing, columns), wall(2, 30.0, 33.0, 0.1, kEverywhere)});
  const View view = ahead();
  const Picture after = drawn(list, view, true);
  std::size_t column = 0, through = 0, gap = 0, filled = 0;
  for (std::size_t i = 0; i < after.depth.size(); ++i) {
    const double off = std::abs(std::remainder(onWall(view, i, 10.0).x, 4.0));
    if (off < 1.0 - 0.5 * spacing) {
      ++column;
      through += after.depth[i] > 20.0f;
    } else if (off > 1.0 + spacing) {
      ++gap;
      filled += after.depth[i] < 20.0f;
    }
  }
  EXPECT_LE(through, column / 100);
  EXPECT_LE(filled, gap / 200);
}

TEST(FloodFill, MakesNothingOfSinglePoints) {
  std::vector<std::shared_ptr<const NodeData>> nodes;
  const RenderList list = test::makeList({wall(1, 10.0, 12.0, 3.0, [](double, double) { return true; })});
  auto lonely = std::make_shared<NodeData>(*list.items[0].node);
  lonely->spacing = 0.1f;  // far less than they lie apart
  const RenderList apart = test::makeList({lonely});
  EXPECT_EQ(drawn(apart, ahead(), false).colour, drawn(apart, ahead(), true).colour);
}

TEST(FloodFill, GivesPointsTheirSizeWhereNothingWasFilled) {
  auto lonely = std::make_shared<NodeData>(*wall(1, 10.0, 12.0, 3.0, kEverywhere));
  lonely->spacing = 0.1f;  // single points
  const RenderList apart = test::makeList({lonely}), sparse = test::makeList({wall(1, 10.0, 12.0, 0.35, kEverywhere)});
  for (const int size : {2, 5}) {
    const Picture large = drawn(apart, ahead(), true, size);
    EXPECT_EQ(drawn(apart, ahead(), false, size).colour, large.colour) << "no splats: squares as ever";
    EXPECT_NE(drawn(apart, ahead(), true).colour, large.colour);
    const Picture filled = drawn(sparse, ahead(), true), both = drawn(sparse, ahead(), true, size);
    for (std::size_t i = 0; i < filled.pointId.size(); ++i) {
      if (filled.pointId[i] == Picture::kNoPoint) continue;
      ASSERT_EQ(both.colour[i], filled.colour[i]) << "a wall that is filled stays smooth";
      ASSERT_EQ(both.pointId[i], filled.pointId[i]);
    }
  }
}

/// The number of pixels that stay empty on a wall of scan lines, whose points are `along` metres apart on lines `apart`
/// metres apart.
std::ptrdiff_t openBetweenLines(double apart, double along, bool ellipses) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> within(0.0, 1.0);
  std::vector<glm::dvec3> points;
  for (double z = -12.0; z < 12.0; z += apart)
    for (double x = -12.0; x < 12.0; x += along)
      points.push_back(kUtm + glm::dvec3(x + along * within(random), 10.0, z + 0.04 * within(random)));
  std::shuffle(points.begin(), points.end(), random);
  auto node = std::make_shared<NodeData>(*test::makeNode(NodeKey(), points, 0.001));
  node->spacing = static_cast<float>(std::sqrt(apart * along));  // of as many points spread evenly
  const RenderList list = test::makeList({node});
  Picture picture = drawn(list, ahead(), false);
  FloodSettings settings;
  settings.ellipses = ellipses;
  floodFill(list, ahead(), settings, pool(), picture);
  return std::count(picture.pointId.begin(), picture.pointId.end(), Picture::kNoPoint);
}

TEST(FloodFill, ClosesTheGapsBetweenScanLines) { EXPECT_LT(openBetweenLines(0.6, 0.12, true), 600); }

TEST(FloodFill, LeavesFewerGapsBetweenScanLinesWithEllipsesThanWithCircles) {
  EXPECT_LT(2 * openBetweenLines(0.9, 0.08, true), openBetweenLines(0.9, 0.08, false));
}

/// A town of which only a share of the points is drawn, while the camera passes slowly.
TEST(FloodFill, FlickersLessThanThePictureWithHoles) {
  const RenderList whole = test::makeTown(kUtm, 100.0, 600000, 1, 4), thin = test::thinned(whole, 0.1, 1);
  View view = viewOfBox(test::boundsOf(whole), {1.0, 0.8, -0.6}, 240, 180, 1.0);
  view.eye = view.target + (view.eye - view.target) * 0.7;
  Picture fullBefore, openBefore, filledBefore;
  View before;
  double open = 0.0, filled = 0.0;
  for (int i = 0; i < 12; ++i) {
    const Picture full = drawn(whole, view, false), holes = drawn(thin, view, false), closed = drawn(thin, view, true);
    if (i > 0) {
      open += test::flicker({view, full, holes}, {before, fullBefore, openBefore});
      filled += test::flicker({view, full, closed}, {before, fullBefore, filledBefore});
    }
    fullBefore = full;
    openBefore = holes;
    filledBefore = closed;
    before = view;
    view.eye += glm::dvec3(0.05, -0.05, 0.01);  // about half a pixel
    view.target += glm::dvec3(0.05, -0.05, 0.01);
  }
  EXPECT_GT(open / 11.0, 1.0);
  EXPECT_LT(filled, 0.9 * open);
}

TEST(FloodFill, IsTheSameForAnyNumberOfThreads) {
  const RenderList list = test::thinned(test::makeTown(kUtm, 100.0, 60000, 1, 4), 0.5, 1);
  View view = viewOfBox(test::boundsOf(list), {1.0, 0.8, -0.6}, 320, 240, 1.0);
  view.eye = view.target + (view.eye - view.target) * 0.5;
  Picture one = drawn(list, view, false), several = one;
  EXPECT_GT(floodFill(list, view, {}, ThreadPool(1), one).filled, 1000u);
  floodFill(list, view, {}, ThreadPool(4), several);
  EXPECT_EQ(one.colour, several.colour);
  EXPECT_EQ(one.depth, several.depth);
  EXPECT_EQ(one.pointId, several.pointId);
}

TEST(FloodFill, WorksWithoutPerspectiveToo) {
  View view = ahead();
  view.orthographic = true;
  view.orthographicHeight = 10.0;
  const Picture picture = drawn(test::makeList({wall(1, 10.0, 12.0, 0.35, kEverywhere)}), view, true);
  std::size_t open = 0;
  for (const float depth : picture.depth) open += std::abs(depth - 10.0f) > 0.05f;
  EXPECT_LE(open, picture.depth.size() / 100);
}

TEST(FloodFill, TakesEmptyAndTinyPictures) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {7, 1}, {3, 3}}) {
    drawn(test::makeList({wall(1, 10.0, 12.0, 0.35, kEverywhere)}), ahead(width, height), true);
    EXPECT_EQ(drawn({}, ahead(width, height), true).pointId[0], Picture::kNoPoint);
  }
}

}  // namespace
}  // namespace strata
