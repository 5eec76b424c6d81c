// Shading, clipping, classes, gaze and several views, on the CPU.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <map>

#include "render/cpu/cpu_draw.h"
#include "render/create_rasterizer.h"
#include "render/picture/colour_map.h"
#include "render/picture/post_process.h"
#include "tests/support/oracle.h"
#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

const glm::dvec3 kUtm(456789.0, 5412345.0, 312.0);

RenderList town() { return test::makeTown(kUtm, 200.0, 150000, 1, 6); }

View aView(const RenderList& list, int size = 512) { return test::viewsAround(test::boundsOf(list), 5, size, size)[1]; }

Picture drawn(const RenderList& list, const View& view, const DrawOptions& options, int threads = 2) {
  RasterizerOptions some;
  some.threads = threads;
  Picture picture;
  createRasterizer(Backend::cpu, some, nullptr)->draw(list, view, options, picture);
  return picture;
}

void expectOraclesPicture(const RenderList& list, const View& view, const DrawOptions& options) {
  const Picture picture = drawn(list, view, options);
  const test::Comparison result = test::compareToOracle(list, view, picture, options);
  EXPECT_GT(result.covered, 500u);
  EXPECT_GE(result.agreement(), 0.999) << result.different << " of " << result.covered << " pixels differ";
  EXPECT_EQ(result.unexplained, 0u) << result.firstUnexplained;
}

/// The pixel and depth of every point in the image, in double precision.
struct Seen {
  std::uint32_t id;
  std::size_t pixel;
  double depth;
};
std::vector<Seen> allSeen(const RenderList& list, const View& view) {
  std::vector<Seen> seen;
  const Projection p = projection(view);
  const ViewConstants constants = viewConstants(view);
  std::uint32_t firstId = 0;
  for (const RenderItem& item : list.items) {
    for (const Batch& batch : item.node->batches) {
      const Precision precision = batchPrecision(constants, *item.node, batch);
      for (std::uint32_t i = batch.firstPoint; i < batch.firstPoint + batch.pointCount; ++i) {
        const glm::dvec4 d(pointPosition(*item.node, batch, i, precision) - p.eye, 1.0);
        const double w = glm::dot(p.rowW, d), depth = glm::dot(p.rowDepth, d);
        const double column = glm::dot(p.rowX, d) / w, row = glm::dot(p.rowY, d) / w;
        if (depth < view.nearPlane || column < 0.0 || row < 0.0 || column >= view.width || row >= view.height) continue;
        const auto pixel =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(column);
        seen.push_back({firstId + i, pixel, depth});
      }
    }
    firstId += item.pointCount;
  }
  return seen;
}

std::uint32_t colourOf(const RenderList& list, std::uint32_t id) {
  for (const RenderItem& item : list.items) {
    if (id < item.pointCount) return item.node->colour[id];
    id -= item.pointCount;
  }
  return 0;
}

TEST(HighQualityShading, IsTheMeanColourOfThePointsWithinOnePerCentOfTheFront) {
  const RenderList list = town();
  for (const View& view : test::viewsAround(test::boundsOf(list), 4, 256, 256)) {
    DrawOptions options;
    options.shading = Shading::highQuality;
    const Picture picture = drawn(list, view, options);
    std::vector<glm::dvec4> sums(picture.colour.size(), glm::dvec4(0.0));
    for (const Seen& point : allSeen(list, view)) {
      if (point.depth > 1.01 * static_cast<double>(picture.depth[point.pixel])) continue;
      const std::uint32_t c = colourOf(list, point.id);
      sums[point.pixel] += glm::dvec4(c & 255u, c >> 8 & 255u, c >> 16 & 255u, 1.0);
    }
    std::size_t covered = 0, different = 0, blended = 0;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      if (picture.pointId[i] == Picture::kNoPoint) continue;
      ++covered;
      blended += sums[i].w > 1.5;
      for (int channel = 0; channel < 3; ++channel)
        if (std::abs(sums[i][channel] / sums[i].w - (picture.colour[i] >> (8 * channel) & 255u)) > 0.51) {
          ++different;
          break;
        }
    }
    EXPECT_GT(blended, 100u);
    // A point on a pixel's edge, or at the very end of the range, may fall to either side.
    EXPECT_LE(static_cast<double>(different), 0.003 * static_cast<double>(covered));
  }
}

TEST(HighQualityShading, LeavesFrontPointsAndDepthsAsTheyAre) {
  const RenderList list = town();
  DrawOptions options;
  const Picture plain = drawn(list, aView(list), options);
  options.shading = Shading::highQuality;
  const Picture blended = drawn(list, aView(list), options), one = drawn(list, aView(list), options, 1);
  EXPECT_EQ(plain.pointId, blended.pointId);
  EXPECT_EQ(plain.depth, blended.depth);
  EXPECT_NE(plain.colour, blended.colour);
  EXPECT_EQ(one.colour, blended.colour);
}

TEST(HighQualityShading, GivesLargePointsTheColourOfThePixelTheyComeFrom) {
  const RenderList list = test::makeList({test::makeNode({}, {kUtm, kUtm + glm::dvec3(0.0, 0.001, 0.0)}, 0.001)});
  View view;
  view.width = view.height = 33;
  view.eye = kUtm - glm::dvec3(0.0, 10.0, 0.0);
  view.target = kUtm;
  DrawOptions options;
  options.shading = Shading::highQuality;
  options.pointSize = 5;
  const Picture picture = drawn(list, view, options);
  std::map<std::uint32_t, int> colours;
  for (std::size_t i = 0; i < picture.colour.size(); ++i)
    if (picture.pointId[i] != Picture::kNoPoint) ++colours[picture.colour[i]];
  ASSERT_EQ(colours.size(), 1u);
  EXPECT_EQ(colours.begin()->second, 25);
}

TEST(Overdraw, CountsThePointsOfEveryPixel) {
  const RenderList list = town();
  const View view = aView(list, 128);
  DrawOptions options;
  options.colour = ColourMode::overdraw;
  std::vector<std::uint32_t> counts(128 * 128, 0);
  for (const Seen& point : allSeen(list, view)) ++counts[point.pixel];
  CpuTarget target;
  const ThreadPool pool(2);
  planBatches(list, view, options, target.plan);
  clearTarget(target, pool);
  drawBatches({&target, 1}, options, pool);
  std::size_t different = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) different += counts[i] != target.buffer.counts[i];
  EXPECT_LE(different, counts.size() / 200);
  EXPECT_GT(*std::max_element(counts.begin(), counts.end()), 5u);
  const Picture picture = drawn(list, view, options);
  const auto largest = static_cast<std::size_t>(
      std::max_element(target.buffer.counts.begin(), target.buffer.counts.end()) - target.buffer.counts.begin());
  EXPECT_EQ(picture.colour[largest], heatColour(1.0));
}

TEST(Clip, DrawsOnlyWhatIsInOneOfTheBoxesAndBeforeAllPlanes) {
  const RenderList list = town();
  const glm::dvec3 off(0.00051);  // no point lies on a border
  DrawOptions options;
  options.clip.boxes = {{kUtm - glm::dvec3(60.0, 60.0, 50.0) + off, kUtm + glm::dvec3(10.0, 20.0, 50.0) + off},
                        {kUtm + glm::dvec3(30.0, -90.0, -10.0) + off, kUtm + glm::dvec3(90.0, 90.0, 8.0) + off}};
  for (const View& view : test::viewsAround(test::boundsOf(list), 8, 300, 300)) {
    options.clip.planes.clear();
    expectOraclesPicture(list, view, options);
    options.clip.planes = {glm::dvec4(1.0, 0.5, 0.0, -kUtm.x - 0.5 * kUtm.y + 40.000511)};
    expectOraclesPicture(list, view, options);
  }
}

TEST(Clip, DrawsNothingThatIsInACutoutWithBoxesAndWithout) {
  const RenderList list = town();
  const glm::dvec3 off(0.00051);  // no point lies on a border
  DrawOptions options;
  for (const View& view : test::viewsAround(test::boundsOf(list), 8, 300, 300)) {
    options.clip = {};
    options.clip.cutouts = {{kUtm - glm::dvec3(60.0, 60.0, 50.0) + off, kUtm + glm::dvec3(10.0, 20.0, 50.0) + off},
                            {kUtm - glm::dvec3(5.0, 5.0, 50.0) + off, kUtm + glm::dvec3(40.0, 60.0, 50.0) + off}};
    expectOraclesPicture(list, view, options);
    options.clip.boxes = {{kUtm - glm::dvec3(80.0, 80.0, 50.0) + off, kUtm + glm::dvec3(80.0, 80.0, 8.0) + off}};
    expectOraclesPicture(list, view, options);
  }
}

TEST(Clip, ACutoutLeavesOutTheBatchesInsideIt) {
  const RenderList list = town();
  const View view = viewOfBox(test::boundsOf(list), {1.0, 0.83, -0.71}, 300, 300, 1.0);
  DrawOptions options;
  DrawPlan whole, clipped;
  planBatches(list, view, options, whole);
  const Box bounds = test::boundsOf(list);
  options.clip.cutouts = {{bounds.min - 1e4, glm::dvec3(bounds.centre().x, bounds.max.y + 1e4, bounds.max.z + 1e4)}};
  planBatches(list, view, options, clipped);
  EXPECT_LT(clipped.batches.size(), whole.batches.size());
  EXPECT_EQ(clipped.batches.size() + clipped.batchesCulled, whole.batches.size() + whole.batchesCulled);
}

TEST(Clip, LeavesOutBatchesThatAreOutside) {
  const RenderList list = town();
  const View view = viewOfBox(test::boundsOf(list), {1.0, 0.83, -0.71}, 300, 300, 1.0);
  DrawOptions options;
  DrawPlan whole, clipped;
  planBatches(list, view, options, whole);
  options.clip.boxes = {{kUtm - 20.0, kUtm + 20.0}};
  planBatches(list, view, options, clipped);
  EXPECT_LT(clipped.batches.size(), whole.batches.size() / 2);
  EXPECT_EQ(clipped.batches.size() + clipped.batchesCulled, whole.batches.size() + whole.batchesCulled);
}

TEST(Classes, AreLeftOutWhereTheyAreNotWanted) {
  const RenderList list = town();
  DrawOptions options;
  options.classes.reset();
  for (const std::size_t wanted : {2u, 6u, 11u}) options.classes.set(wanted);
  for (const View& view : test::viewsAround(test::boundsOf(list), 4, 300, 300))
    expectOraclesPicture(list, view, options);
  const Picture picture = drawn(list, aView(list), options);
  std::uint32_t firstId = 0;
  for (const RenderItem& item : list.items) {
    for (const std::uint32_t id : picture.pointId)
      if (id - firstId < item.pointCount) {
        EXPECT_TRUE(options.classes[item.node->classification[id - firstId]]);
      }
    firstId += item.pointCount;
  }
}

TEST(Gaze, LeavesOutNodesThatAreSmallAndFarFromIt) {
  const RenderList list = town();
  const View view = viewOfBox(test::boundsOf(list), {1.0, 0.83, -0.71}, 600, 300, 1.0);
  DrawOptions options;
  DrawPlan whole, gazed;
  planBatches(list, view, options, whole);
  options.gaze = {true, {0.2f, 0.5f}, 10.0f, 200.0f};
  planBatches(list, view, options, gazed);
  EXPECT_GT(gazed.batches.size(), 0u);
  EXPECT_LT(gazed.batches.size(), whole.batches.size());
  CpuTarget target;  // the picture before its holes are filled
  const ThreadPool pool(2);
  planBatches(list, view, options, target.plan);
  clearTarget(target, pool);
  drawBatches({&target, 1}, options, pool);
  Picture picture;
  for (const PackedPixel pixel : target.buffer.pixels) picture.pointId.push_back(pixelId(pixel));
  const test::Comparison result = test::compareToOracle(list, view, picture, options);
  EXPECT_GE(result.agreement(), 0.999);
  EXPECT_EQ(result.unexplained, 0u) << result.firstUnexplained;
  options.gaze = {true, {0.2f, 0.5f}, 0.0f, 0.0f};
  planBatches(list, view, options, gazed);
  EXPECT_EQ(gazed.batches.size(), whole.batches.size());
}

TEST(SeveralViews, AreTheSameAsOneAfterTheOther) {
  const RenderList list = town();
  for (const View& left : test::viewsAround(test::boundsOf(list), 6, 320, 240)) {
    View right = left;
    right.eye += 0.3 * viewBasis(left).right;
    right.target += 0.3 * viewBasis(left).right;
    View third = left;
    third.eye = left.target + (left.eye - left.target) * 30.0;  // other precisions
    for (int mode = 0; mode < 3; ++mode) {
      DrawOptions options;
      options.shading = mode == 1 ? Shading::highQuality : Shading::plain;
      options.gaze.on = mode == 2;
      options.pointSize = mode == 2 ? 2 : 1;
      if (mode == 2) options.clip.boxes = {{kUtm - 40.0, kUtm + 60.0}};
      const View views[] = {left, right, third};
      Picture pictures[3];
      const DrawStats stats = createRasterizer(Backend::cpu, {}, nullptr)->drawViews(list, views, options, pictures);
      std::uint64_t points = 0;
      for (int v = 0; v < 3; ++v) {
        Picture alone;
        points += createRasterizer(Backend::cpu, {}, nullptr)->draw(list, views[v], options, alone).pointsDrawn;
        EXPECT_EQ(pictures[v].pointId, alone.pointId);
        EXPECT_EQ(pictures[v].depth, alone.depth);
        EXPECT_EQ(pictures[v].colour, alone.colour);
      }
      EXPECT_EQ(stats.pointsDrawn, points);
    }
  }
}

TEST(Background, MayRunFromOneColourAtTheTopToAnotherBelow) {
  DrawOptions options;
  options.background = {10, 20, 30};
  options.backgroundBelow = glm::u8vec3(110, 220, 0);
  View view;
  view.width = 3;
  view.height = 11;
  const Picture picture = drawn({}, view, options);
  EXPECT_EQ(picture.colour[0], packColour(10, 20, 30));
  EXPECT_EQ(picture.colour[5 * 3], packColour(60, 120, 15));
  EXPECT_EQ(picture.colour[10 * 3 + 2], packColour(110, 220, 0));
}

TEST(Precision, IsShownAsItWasDrawn) {
  const RenderList list = town();
  DrawOptions options;
  options.colour = ColourMode::precision;
  for (const View& view : test::viewsAround(test::boundsOf(list), 6, 200, 200)) {
    DrawPlan plan;
    planBatches(list, view, options, plan);
    const Picture picture = drawn(list, view, options);
    for (std::size_t i = 0; i < picture.colour.size(); i += 7) {
      if (picture.pointId[i] == Picture::kNoPoint) continue;
      const auto batch = std::find_if(plan.batches.begin(), plan.batches.end(), [&](const PlannedBatch& b) {
        return picture.pointId[i] - b.firstId < b.pointCount;
      });
      ASSERT_NE(batch, plan.batches.end());
      ASSERT_EQ(picture.colour[i], precisionColour(static_cast<int>(batch->precision)));
    }
  }
}

/// fillHoles() written plainly, as its comment describes it.
std::vector<PackedPixel> filledPlainly(const std::vector<PackedPixel>& from, int width, int height, int side) {
  std::vector<PackedPixel> to = from;
  const auto depthAt = [&](int x, int y) { return pixelDepth(from[static_cast<std::size_t>(y * width + x)]); };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float front = std::numeric_limits<float>::infinity();
      const int reach = side / 2;
      const auto eachOf = [&](auto use) {
        for (int v = std::max(y - reach, 0); v <= std::min(y + reach, height - 1); ++v)
          for (int u = std::max(x - reach, 0); u <= std::min(x + reach, width - 1); ++u) use(u, v);
      };
      eachOf([&](int u, int v) { front = std::min(front, depthAt(u, v)); });
      if (std::isinf(front) || depthAt(x, y) <= front * 1.01f) continue;
      int nearest = 1000;
      eachOf([&](int u, int v) {
        const int distance = (u - x) * (u - x) + (v - y) * (v - y);
        if (depthAt(u, v) > front * 1.01f || distance >= nearest) return;
        nearest = distance;
        to[static_cast<std::size_t>(y * width + x)] = from[static_cast<std::size_t>(v * width + u)];
      });
    }
  return to;
}

TEST(FillHoles, TakesTheNearestPixelOfTheFrontAndLeavesTheFrontAlone) {
  std::uint32_t state = 1;
  const auto random = [&state] { return (state = state * 1664525u + 1013904223u) >> 8; };
  for (const int side : {3, 5, 7}) {
    VisibilityBuffer buffer;
    buffer.width = 61;
    buffer.height = 37;
    for (std::uint32_t i = 0; i < 61 * 37; ++i) {
      const float depth = 1.0f + 0.004f * static_cast<float>(random() % 4) + 3.0f * static_cast<float>(random() % 2);
      buffer.pixels.push_back(random() % 5 != 0 ? kEmptyPixel : packPixel(std::bit_cast<std::uint32_t>(depth), i));
    }
    const std::vector<PackedPixel> before = buffer.pixels;
    DrawOptions options;
    options.fill = side;
    View view;
    view.width = buffer.width;
    view.height = buffer.height;
    fillHoles(buffer, FillSizes(options, view), ThreadPool(2));
    EXPECT_EQ(buffer.pixels, filledPlainly(before, buffer.width, buffer.height, side));
    EXPECT_NE(buffer.pixels, before);
  }
}

TEST(FillSizes, GrowWithTheDistanceFromTheGaze) {
  DrawOptions options;
  options.gaze.on = true;
  View view;
  view.width = 900;
  view.height = 300;
  const FillSizes sizes(options, view);
  EXPECT_EQ(sizes.at(450, 150), 3);
  EXPECT_EQ(sizes.at(600, 150), 5);
  EXPECT_EQ(sizes.at(20, 20), 7);
}

TEST(NearPlane, HoldsPointsThatLieOnIt) {
  std::vector<glm::dvec3> points;
  for (int i = -20; i <= 20; ++i)
    for (const double y : {-1.0, 0.0, 0.499, 0.5, 0.75}) points.emplace_back(0.01 * i, y, 0.003);
  const RenderList list = test::makeList({test::makeNode({}, points, 0.001)});
  View view;
  view.eye = {0.0, 0.0, 0.0};
  view.target = {0.0, 1.0, 0.0};
  view.nearPlane = 0.5;
  view.width = view.height = 401;
  const Picture picture = drawn(list, view, {});
  std::size_t onPlane = 0;
  for (const float depth : picture.depth) {
    EXPECT_GE(depth, 0.5f);
    onPlane += depth == 0.5f;
  }
  EXPECT_GT(onPlane, 30u);
}

}  // namespace
}  // namespace strata
