// Hole filling in compute shaders, compared with that on the CPU.
#include <gtest/gtest.h>

#include <algorithm>

#include "render/create_rasterizer.h"
#include "render/flood/gl_flood.h"
#include "tests/support/faithful_flood.h"
#include "tests/support/fill_judge.h"
#include "tests/support/gl_contexts.h"
#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

constexpr glm::dvec3 kUtm(456789.0, 5412345.0, 300.0);
constexpr int kSameColour = 2;            ///< of 255
constexpr double kMostOther = 0.005;      ///< share of pixels that may differ by more
constexpr double kMostOtherIds = 0.02;    ///< two splats of nearly the same weight
constexpr double kMostUncovered = 0.001;  ///< ... that only one of the two fills

class GlFloodTest : public testing::TestWithParam<test::ContextKind> {
 protected:
  void SetUp() override {
    std::string reason;
    context_ = test::tryContext(GetParam(), reason);
    if (context_ == nullptr) GTEST_SKIP() << reason;
    context_->makeCurrent();
    gl_ = loadGlFunctions(*context_);
    flood_ = std::make_unique<GlFlood>(gl_, 8);
  }
  void TearDown() override {
    if (context_ != nullptr) context_->makeCurrent();
    flood_.reset();
  }

  static RenderList town(bool normals = false) {
    RenderList list = test::thinned(test::makeTown(kUtm, 100.0, 150000, 1, 4), 0.4, 1);
    if (!normals) return list;
    for (RenderItem& item : list.items) {
      auto node = std::make_shared<NodeData>(*item.node);
      node->normal.clear();
      for (std::uint32_t i = 0; i < node->pointCount(); ++i)
        node->normal.push_back(packNormal(i % 3 == 0 ? glm::vec3(0.0f) : glm::vec3(0.6f, 0.0f, 0.8f)));
      item.node = std::move(node);
    }
    return list;
  }

  void expectTheCpusPicture(const RenderList& list, const View& view, const FloodSettings& settings,
                            std::uint64_t leastFilled = 500) {
    Picture holes;
    createRasterizer(Backend::cpu, {}, nullptr)->draw(list, view, {}, holes);
    Picture expected = holes, picture = holes;
    const ThreadPool pool(2);
    EXPECT_GE(floodFill(list, view, settings, pool, expected).filled, leastFilled);
    context_->makeCurrent();
    flood_->fill(list, view, settings, pool, picture);
    std::size_t otherColours = 0, otherIds = 0, uncovered = 0, farther = 0;
    for (std::size_t i = 0; i < expected.colour.size(); ++i) {
      int largest = 0;
      for (int shift = 0; shift < 24; shift += 8)
        largest = std::max(largest, std::abs(static_cast<int>(expected.colour[i] >> shift & 255u) -
                                             static_cast<int>(picture.colour[i] >> shift & 255u)));
      otherColours += largest > kSameColour;
      otherIds += expected.pointId[i] != picture.pointId[i];
      uncovered += (expected.pointId[i] == Picture::kNoPoint) != (picture.pointId[i] == Picture::kNoPoint);
      farther += expected.pointId[i] == picture.pointId[i] && expected.pointId[i] != Picture::kNoPoint &&
                 !(std::abs(expected.depth[i] - picture.depth[i]) <= 0.002f * expected.depth[i]);
    }
    const auto share = [&](double of) { return of * static_cast<double>(expected.colour.size()); };
    EXPECT_LE(static_cast<double>(otherColours), share(kMostOther));
    EXPECT_LE(static_cast<double>(otherIds), share(kMostOtherIds));
    EXPECT_LE(static_cast<double>(uncovered), share(kMostUncovered));
    EXPECT_LE(static_cast<double>(farther), share(kMostOther));
  }

  static View viewOf(const RenderList& list, double closer, int width = 320, int height = 240) {
    View view = viewOfBox(test::boundsOf(list), {1.0, 0.8, -0.6}, width, height, 1.0);
    view.eye = view.target + (view.eye - view.target) * closer;
    return view;
  }

  std::unique_ptr<GlContext> context_;
  GlFunctions gl_;
  std::unique_ptr<GlFlood> flood_;
};

TEST_P(GlFloodTest, HasTheCpusPictureFromFarAndNear) {
  const RenderList list = town();
  for (const double closer : {0.8, 0.4, 0.1}) expectTheCpusPicture(list, viewOf(list, closer), {});
}

TEST_P(GlFloodTest, HasTheCpusPictureWithNormals) {
  const RenderList list = town(true);
  expectTheCpusPicture(list, viewOf(list, 0.4), {});
}

TEST_P(GlFloodTest, HasTheCpusPictureWithThePapersSettings) {
  const RenderList list = town();
  expectTheCpusPicture(list, viewOf(list, 0.5), test::faithfulFlood(100.0f, 0.02f));
}

TEST_P(GlFloodTest, HasTheCpusPictureWithoutPerspective) {
  const RenderList list = town();
  View view = viewOf(list, 0.5);
  view.orthographic = true;
  view.orthographicHeight = 40.0;
  expectTheCpusPicture(list, view, {});
}

TEST_P(GlFloodTest, TakesPicturesOfAnySize) {
  const RenderList list = town();
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 5}, {8, 1}, {321, 179}, {200, 150}})
    expectTheCpusPicture(list, viewOf(list, 0.4, width, height), {}, 0);
  const ThreadPool pool(1);
  Picture empty;
  createRasterizer(Backend::cpu, {}, nullptr)->draw({}, viewOf(list, 1.0), {}, empty);
  const Picture before = empty;
  context_->makeCurrent();
  flood_->fill({}, viewOf(list, 1.0), {}, pool, empty);
  EXPECT_EQ(before.colour, empty.colour);
}

TEST_P(GlFloodTest, DrawsTheSameTwice) {
  const RenderList list = town();
  const View view = viewOf(list, 0.4);
  Picture first;
  createRasterizer(Backend::cpu, {}, nullptr)->draw(list, view, {}, first);
  Picture second = first;
  const ThreadPool pool(1);
  context_->makeCurrent();
  flood_->fill(list, view, {}, pool, first);
  flood_->fill(list, view, {}, pool, second);
  EXPECT_EQ(first.colour, second.colour);
  EXPECT_EQ(first.depth, second.depth);
  EXPECT_EQ(first.pointId, second.pointId);
}

INSTANTIATE_TEST_SUITE_P(Contexts, GlFloodTest, testing::Values(test::ContextKind::egl, test::ContextKind::osMesa),
                         [](const auto& tested) { return test::contextName(tested.param); });

/// Drawing and filling share the bindings of one context.
class FillingRasterizer : public testing::TestWithParam<Backend> {};

TEST_P(FillingRasterizer, DrawsFrameAfterFrameAsTheCpuDoes) {
  std::string reason;
  auto context = test::tryContext(test::ContextKind::egl, reason);
  if (context == nullptr) GTEST_SKIP() << reason;
  const auto rasterizer = createRasterizer(GetParam(), {}, std::move(context));
  const RenderList list = test::thinned(test::makeTown(kUtm, 100.0, 150000, 1, 4), 0.4, 1);
  View view = viewOfBox(test::boundsOf(list), {1.0, 0.8, -0.6}, 240, 180, 1.0);
  view.eye = view.target + (view.eye - view.target) * 0.5;
  DrawOptions options;
  for (const bool fill : {true, false, true, true}) {
    options.jumpFlood = fill;
    Picture expected, picture;
    createRasterizer(Backend::cpu, {}, nullptr)->draw(list, view, options, expected);
    rasterizer->draw(list, view, options, picture);
    std::size_t other = 0;
    for (std::size_t i = 0; i < expected.colour.size(); ++i)
      for (int shift = 0; shift < 24; shift += 8)
        if (std::abs(static_cast<int>(expected.colour[i] >> shift & 255u) -
                     static_cast<int>(picture.colour[i] >> shift & 255u)) > kSameColour) {
          ++other;
          break;
        }
    EXPECT_LE(static_cast<double>(other), 0.01 * static_cast<double>(expected.colour.size())) << fill;
    view.eye += glm::dvec3(0.3, 0.1, 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, FillingRasterizer,
                         testing::Values(Backend::compute32, Backend::computeLock, Backend::points),
                         [](const auto& tested) {
                           return tested.param == Backend::points      ? "points"
                                  : tested.param == Backend::compute32 ? "compute32"
                                                                       : "compute_lock";
                         });

}  // namespace
}  // namespace strata
