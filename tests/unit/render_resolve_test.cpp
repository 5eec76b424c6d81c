#include "render/picture/resolve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <set>

#include "core/error.h"
#include "render/create_rasterizer.h"
#include "render/picture/colour_map.h"
#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

/// Node i has (i * 7919) % 9000 points, whose colour is the node's number, then their own.
RenderList numberedNodes(std::uint32_t nodes) {
  std::vector<std::shared_ptr<const NodeData>> made;
  for (std::uint32_t i = 0; i < nodes; ++i) {
    auto node = std::make_shared<NodeData>();
    const std::uint32_t count = i * 7919 % 9000;
    node->position[0].assign(count, 0);
    for (std::uint32_t p = 0; p < count; ++p) node->colour.push_back(i << 16 | p);
    made.push_back(node);
  }
  return test::makeList(made);
}

TEST(Resolve, FindsThePointOfEveryId) {
  RenderList list = numberedNodes(300);
  list.pointCount = 0;
  for (RenderItem& item : list.items) {
    item.pointCount = item.pointCount % 3 == 0 ? item.pointCount : item.pointCount / 50;
    list.pointCount += item.pointCount;
  }
  VisibilityBuffer buffer{static_cast<int>(list.pointCount), 1, {}};
  for (std::uint32_t id = 0; id < list.pointCount; ++id)
    buffer.pixels.push_back(packPixel(std::bit_cast<std::uint32_t>(1.0f), id));
  Picture picture;
  resolvePicture({list, View{}, {}}, {ThreadPool(2)}, buffer, picture);
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < list.items.size(); ++i)
    for (std::uint32_t p = 0; p < list.items[i].pointCount; ++p, ++at) ASSERT_EQ(picture.colour[at], i << 16 | p);
}

TEST(Resolve, ColoursByTheModeThatIsAskedFor) {
  auto node = std::make_shared<NodeData>(
      *test::makeNode(NodeKey{}.child(1).child(2), {{0.0, 0.0, 10.0}, {1.0, 1.0, 20.0}}, 0.001));
  node->intensity = {1000, 3000};
  node->classification = {2, 6};
  const RenderList list = test::makeList({node});
  const auto colours = [&](const DrawOptions& options) {
    VisibilityBuffer buffer{3, 1, {packPixel(0x3f800000u, 0), packPixel(0x3f800000u, 1), kEmptyPixel}};
    Picture picture;
    resolvePicture({list, View{}, options}, {ThreadPool(1)}, buffer, picture);
    EXPECT_EQ(picture.pointId[2], Picture::kNoPoint);
    EXPECT_EQ(picture.depth[2], std::numeric_limits<float>::infinity());
    EXPECT_EQ(picture.colour[2], packColour(1, 2, 3));
    return std::pair{picture.colour[0], picture.colour[1]};
  };
  DrawOptions options;
  options.background = {1, 2, 3};
  EXPECT_EQ(colours(options), std::pair(node->colour[0], node->colour[1]));
  options.colour = ColourMode::intensity;
  options.intensityRange = {1000.0f, 2000.0f};
  EXPECT_EQ(colours(options), std::pair(packColour(0, 0, 0), packColour(255, 255, 255)));
  options.colour = ColourMode::elevation;
  options.elevationRange = {10.0, 20.0};
  EXPECT_EQ(colours(options), std::pair(elevationColour(0.0), elevationColour(1.0)));
  options.colour = ColourMode::classification;
  EXPECT_EQ(colours(options), std::pair(classificationColour(2), classificationColour(6)));
  options.colour = ColourMode::level;
  EXPECT_EQ(colours(options), std::pair(levelColour(2), levelColour(2)));
  options.colour = ColourMode::returnNumber;
  EXPECT_EQ(colours(options), std::pair(missingColour(), missingColour()));
  node->returnNumber = {1, 2};
  EXPECT_EQ(colours(options), std::pair(returnColour(1), returnColour(2)));
  EXPECT_NE(returnColour(1), returnColour(2));
  options.colour = ColourMode::normal;
  EXPECT_EQ(colours(options), std::pair(missingColour(), missingColour()));
  node->normal = {packNormal({0.0f, 0.0f, 3.0f}), packNormal({-1.0f, 0.0f, 0.0f})};
  EXPECT_EQ(colours(options), std::pair(packColour(127, 127, 255), packColour(0, 127, 127)));
  node->colour.clear();
  options.colour = ColourMode::rgb;
  EXPECT_EQ(colours(options), std::pair(missingColour(), missingColour()));
}

TEST(ColourMap, RisesEvenlyInLightnessWithTheElevation) {
  double before = -1.0;
  for (int i = 0; i <= 100; ++i) {
    const std::uint32_t c = elevationColour(i / 100.0);
    const double lightness = 0.2126 * (c & 255u) + 0.7152 * (c >> 8 & 255u) + 0.0722 * (c >> 16 & 255u);
    EXPECT_GE(lightness, before);
    before = lightness;
  }
  EXPECT_EQ(elevationColour(-5.0), elevationColour(0.0));
  EXPECT_EQ(elevationColour(5.0), elevationColour(1.0));
  EXPECT_EQ(elevationColour(std::numeric_limits<double>::quiet_NaN()), elevationColour(0.0));
}

TEST(Backends, AreKnownByName) {
  EXPECT_EQ(parseBackend("auto"), Backend::automatic);
  EXPECT_EQ(parseBackend("cpu"), Backend::cpu);
  EXPECT_EQ(parseBackend("compute32"), Backend::compute32);
  EXPECT_EQ(parseBackend("points"), Backend::points);
  EXPECT_THROW(parseBackend("opengl"), UsageError);
  EXPECT_EQ(createRasterizer(Backend::automatic, {}, nullptr)->name(), "cpu");
  EXPECT_THROW(createRasterizer(Backend::compute32, {}, nullptr), Error);
  EXPECT_THROW(createRasterizer(Backend::points, {}, nullptr), Error);
}

}  // namespace
}  // namespace strata
