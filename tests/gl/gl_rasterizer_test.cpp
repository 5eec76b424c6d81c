#include <gtest/gtest.h>

#include <random>

#include "render/create_rasterizer.h"
#include "render/gpu/compute_rasterizer.h"
#include "tests/support/gl_contexts.h"
#include "tests/support/oracle.h"
#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

using test::ContextKind;

const glm::dvec3 kUtm(456789.123, 5412345.678, 312.5);
/// Has none of the symmetries of a grid. With them many points would have the same depth, and rounding would decide.
const glm::dvec3 kDirection(1.0, 0.83, -0.71);

/// Runs before any test makes a context.
const bool kOffered = (test::offerWideAtomicsInSoftware(), true);

class GlRasterizer : public testing::TestWithParam<std::tuple<Backend, ContextKind>> {
 protected:
  /// False where there is no context. The test is then skipped.
  bool create(const RasterizerOptions& options = {}) {
    std::string reason;
    auto context = test::tryContext(std::get<1>(GetParam()), reason);
    if (context == nullptr) return false;
    if (backend() == Backend::compute64 && !hasWideAtomics(*context)) return false;
    rasterizer_ = createRasterizer(std::get<0>(GetParam()), options, std::move(context));
    return true;
  }

  Backend backend() const { return std::get<0>(GetParam()); }

  /// The points rasterizer may resolve a tie of depths either way.
  double wantedAgreement() const { return backend() == Backend::points ? 0.995 : 0.999; }

  void expectOraclesPicture(const RenderList& list, const View& view) {
    rasterizer_->draw(list, view, {}, picture_);
    const test::Comparison result = test::compareToOracle(list, view, picture_);
    EXPECT_GE(result.agreement(), wantedAgreement()) << result.different << " of " << result.covered << " differ";
    EXPECT_EQ(result.unexplained, 0u) << result.firstUnexplained;
    covered_ += result.covered;
  }

  std::unique_ptr<Rasterizer> rasterizer_;
  Picture picture_;
  std::uint64_t covered_ = 0;
};

#define STRATA_CREATE_OR_SKIP(...) \
  if (!create(__VA_ARGS__)) GTEST_SKIP() << "no " << test::contextName(std::get<1>(GetParam())) << " context here"

std::size_t coveredPixels(const Picture& picture) {
  std::size_t covered = 0;
  for (const std::uint32_t id : picture.pointId) covered += id != Picture::kNoPoint;
  return covered;
}

TEST_P(GlRasterizer, GivesTheOraclesPictureOfATownFromAllSides) {
  STRATA_CREATE_OR_SKIP();
  const RenderList list = test::makeTown(kUtm, 200.0, 100000, 1);
  for (const View& view : test::viewsAround(test::boundsOf(list), 12, 512, 512)) expectOraclesPicture(list, view);
  EXPECT_GT(covered_, 100000u);
}

TEST_P(GlRasterizer, GivesTheOraclesPictureAtFullHighDefinition) {
  STRATA_CREATE_OR_SKIP();
  const RenderList list = test::makeTown(kUtm, 500.0, 500000, 2);
  for (const View& view : test::viewsAround(test::boundsOf(list), 2, 1920, 1080)) expectOraclesPicture(list, view);
}

TEST_P(GlRasterizer, DrawsOnlyThePrefixOfEachNode) {
  STRATA_CREATE_OR_SKIP();
  RenderList list = test::makeTown(kUtm, 200.0, 100000, 3);
  list.pointCount = 0;
  for (RenderItem& item : list.items) {
    item.pointCount /= 3;
    list.pointCount += item.pointCount;
  }
  list.pointCount -= list.items[2].pointCount;
  list.items[2].pointCount = 0;
  for (const View& view : test::viewsAround(test::boundsOf(list), 4, 512, 512)) expectOraclesPicture(list, view);
}

TEST_P(GlRasterizer, DrawsHugeCoordinatesFromClose) {
  STRATA_CREATE_OR_SKIP();
  const glm::dvec3 far(1e7, -1e7, 1e7);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<glm::dvec3> near(100000), wide(100000);
  for (glm::dvec3& p : near) p = far + glm::dvec3(unit(random), unit(random), unit(random));
  for (glm::dvec3& p : wide) p = far + 1e5 * (glm::dvec3(unit(random), unit(random), unit(random)) - 0.5);
  const RenderList list = test::makeList({test::makeNode({}, near, 1e-5), test::makeNode({}, wide, 1e-3)});
  for (int i = 0; i < 4; ++i) {
    View view;
    view.width = view.height = 512;
    view.eye = far + glm::dvec3(0.5, 0.2 - 0.2 * i, 0.5);
    view.target = view.eye + glm::dvec3(0.1, 1.0, 0.0);
    expectOraclesPicture(list, view);
  }
}

TEST_P(GlRasterizer, DrawsNothingOfNothingAndOnePixelOfOnePoint) {
  STRATA_CREATE_OR_SKIP();
  View view = viewOfBox({kUtm - 1.0, kUtm + 1.0}, kDirection, 301, 201, 1.0);
  rasterizer_->draw({}, view, {}, picture_);
  EXPECT_EQ(coveredPixels(picture_), 0u);
  const RenderList list = test::makeList({test::makeNode({}, {kUtm}, 0.001)});
  expectOraclesPicture(list, view);
  EXPECT_EQ(coveredPixels(picture_), 1u);
  view.width = view.height = 1;
  expectOraclesPicture(list, view);
  view.width = 0;
  rasterizer_->draw(list, view, {}, picture_);
  EXPECT_TRUE(picture_.colour.empty());
}

TEST_P(GlRasterizer, GivesTheSameColoursAsTheCpu) {
  STRATA_CREATE_OR_SKIP();
  const RenderList list = test::makeTown(kUtm, 200.0, 100000, 5);
  const auto cpu = createRasterizer(Backend::cpu, {}, nullptr);
  const View view = test::viewsAround(test::boundsOf(list), 4, 512, 512)[1];
  DrawOptions options;
  options.elevationRange = {300.0, 350.0};
  for (const ColourMode mode :
       {ColourMode::rgb, ColourMode::intensity, ColourMode::elevation, ColourMode::classification, ColourMode::level}) {
    options.colour = mode;
    options.pointSize = mode == ColourMode::elevation ? 3 : 1;
    Picture expected;
    rasterizer_->draw(list, view, options, picture_);
    cpu->draw(list, view, options, expected);
    std::size_t otherIds = 0, otherColours = 0;
    for (std::size_t i = 0; i < expected.pointId.size(); ++i) {
      const bool same = expected.pointId[i] == picture_.pointId[i];
      otherIds += !same;
      otherColours += same && expected.colour[i] != picture_.colour[i];
    }
    EXPECT_EQ(otherColours, 0u);
    // A point that falls to the other side of a pixel's edge changes pointSize^2 pixels.
    const double allowed = (1.0 - wantedAgreement()) * options.pointSize * options.pointSize;
    EXPECT_LE(static_cast<double>(otherIds), allowed * static_cast<double>(expected.pointId.size()));
  }
}

TEST_P(GlRasterizer, UploadsUnderTheBudgetOfAFrameUntilAllIsThere) {
  RasterizerOptions options;
  options.uploadBytesPerFrame = 400000;
  STRATA_CREATE_OR_SKIP(options);
  const RenderList list = test::makeTown(kUtm, 200.0, 200000, 6);
  const View view = viewOfBox(test::boundsOf(list), kDirection, 512, 512, 1.0);
  std::uint64_t largest = 0;
  for (const RenderItem& item : list.items) largest = std::max(largest, std::uint64_t{item.pointCount} * 12);
  std::uint32_t missing = static_cast<std::uint32_t>(list.items.size());
  for (int frames = 0; missing > 0; ++frames) {
    ASSERT_LT(frames, 20);
    const DrawStats stats = rasterizer_->draw(list, view, {}, picture_);
    EXPECT_LE(stats.bytesUploaded, std::max(options.uploadBytesPerFrame, largest));
    EXPECT_LT(stats.nodesNotUploaded, missing);
    missing = stats.nodesNotUploaded;
  }
  expectOraclesPicture(list, view);
  EXPECT_EQ(rasterizer_->draw(list, view, {}, picture_).bytesUploaded, 0u);
}

TEST_P(GlRasterizer, HoldsNoMoreThanItsMemoryAndDrawsWhatFits) {
  RasterizerOptions options;
  options.gpuBytes = 1000000;
  STRATA_CREATE_OR_SKIP(options);
  const RenderList list = test::makeTown(kUtm, 200.0, 200000, 7);
  const View view = viewOfBox(test::boundsOf(list), kDirection, 512, 512, 1.0);
  const DrawStats stats = rasterizer_->draw(list, view, {}, picture_);
  EXPECT_LE(stats.gpuBytes, options.gpuBytes);
  EXPECT_GT(stats.nodesNotUploaded, 0u);
  EXPECT_GT(stats.pointsDrawn, 0u);
  for (std::size_t i = 0; i < list.items.size(); ++i) {  // one after another, each evicting those before
    const RenderList one = test::makeList({list.items[i].node});
    if (one.pointCount * 8 > options.gpuBytes || one.pointCount == 0) continue;
    EXPECT_EQ(rasterizer_->draw(one, view, {}, picture_).nodesNotUploaded, 0u);
    expectOraclesPicture(one, view);
  }
}

TEST_P(GlRasterizer, NeverDrawsAFreedNodeInPlaceOfAnother) {
  STRATA_CREATE_OR_SKIP();
  const View view = viewOfBox({kUtm - 1.0, kUtm + 1.0}, kDirection, 256, 256, 1.0);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int round = 0; round < 20; ++round) {  // the allocator likes to give the same address again
    std::vector<glm::dvec3> points(20000);
    for (glm::dvec3& p : points) p = kUtm + glm::dvec3(unit(random), unit(random), unit(random));
    auto* copy = new NodeData(*test::makeNode({}, points, 0.001));
    expectOraclesPicture(test::makeList({std::shared_ptr<const NodeData>(copy)}), view);
  }
}

/// A node of 20 000 points around kUtm, then copies of its batches up to `count` points.
std::shared_ptr<const NodeData> longNode(int child, std::uint32_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<glm::dvec3> points(20000);
  for (glm::dvec3& p : points) p = kUtm + glm::dvec3(unit(random), unit(random), unit(random));
  NodeData node = *test::makeNode(NodeKey{}.child(child), points, 0.00001, 10000, 3);
  while (node.pointCount() < count) {
    for (const std::size_t b : {0, 1}) {
      Batch batch = node.batches[b];
      for (auto& plane : node.position)
        plane.insert(plane.end(), plane.begin() + batch.firstPoint, plane.begin() + batch.firstPoint + 10000);
      batch.firstPoint = node.pointCount() - 10000;
      node.batches.push_back(batch);
    }
  }
  for (auto* attribute : {&node.colour}) attribute->resize(node.pointCount(), 0xff808080u);
  node.intensity.resize(node.pointCount());
  node.classification.resize(node.pointCount());
  return std::make_shared<const NodeData>(std::move(node));
}

TEST_P(GlRasterizer, DrawsFromManyPages) {
  RasterizerOptions options;
  options.gpuBytes = std::uint64_t{300} << 20;
  options.uploadBytesPerFrame = options.gpuBytes;
  STRATA_CREATE_OR_SKIP(options);
  std::vector<std::shared_ptr<const NodeData>> nodes;
  for (int i = 0; i < 3; ++i) nodes.push_back(longNode(i, 2400000, 9 + static_cast<std::uint32_t>(i)));
  RenderList list = test::makeList(nodes);
  for (RenderItem& item : list.items) item.pointCount = 20000;
  list.pointCount = 60000;
  const View view = viewOfBox({kUtm - 1.0, kUtm + 1.0}, kDirection, 512, 512, 1.0);
  expectOraclesPicture(list, view);
  EXPECT_GE(rasterizer_->draw(list, view, {}, picture_).gpuBytes, 2 * (std::uint64_t{64} << 20));
}

TEST_P(GlRasterizer, DrawsANodeLongerThanAPage) {
  RasterizerOptions options;
  options.gpuBytes = std::uint64_t{200} << 20;
  STRATA_CREATE_OR_SKIP(options);
  if (std::get<1>(GetParam()) != ContextKind::egl || backend() == Backend::points) GTEST_SKIP() << "once is enough";
  const RenderList list = test::makeList({longNode(0, 6000000, 9)});
  const View view = viewOfBox({kUtm - 1.0, kUtm + 1.0}, kDirection, 300, 300, 1.0);
  expectOraclesPicture(list, view);
  EXPECT_EQ(rasterizer_->draw(list, view, {}, picture_).nodesNotUploaded, 0u);
}

TEST_P(GlRasterizer, DrawsAnImageLargerThanOneStorageBlock) {
  STRATA_CREATE_OR_SKIP();
  if (backend() != Backend::compute64) GTEST_SKIP() << "its pixels are the longest";
  const RenderList list = test::makeTown(kUtm, 200.0, 50000, 10);
  expectOraclesPicture(list, viewOfBox(test::boundsOf(list), kDirection, 4096, 4200, 1.0));
}

std::string backendName(Backend backend) {
  return backend == Backend::compute64     ? "Compute64"
         : backend == Backend::compute32   ? "Compute32"
         : backend == Backend::computeLock ? "ComputeLock"
                                           : "Points";
}

INSTANTIATE_TEST_SUITE_P(All, GlRasterizer,
                         testing::Combine(testing::Values(Backend::compute64, Backend::compute32, Backend::computeLock,
                                                          Backend::points),
                                          testing::Values(ContextKind::egl, ContextKind::osMesa)),
                         [](const testing::TestParamInfo<std::tuple<Backend, ContextKind>>& instance) {
                           return backendName(std::get<0>(instance.param)) +
                                  test::contextName(std::get<1>(instance.param));
                         });

}  // namespace
}  // namespace strata
