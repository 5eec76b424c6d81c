#include "viewer/session/draw_flags.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace strata {
namespace {

TEST(DrawFlags, NameClassesOneByOneAndAsRanges) {
  const std::bitset<256> classes = parseClasses("2,6,9-11,255");
  EXPECT_EQ(classes.count(), 6u);
  for (const std::size_t c : {2u, 6u, 9u, 10u, 11u, 255u}) EXPECT_TRUE(classes[c]);
  for (const char* wrong : {"256", "2,,6", "a", "6-2", "-3", "2-", "1.5"})
    EXPECT_THROW(parseClasses(wrong), UsageError) << wrong;
}

TEST(DrawFlags, NameColoursByTheirDigits) {
  EXPECT_EQ(parseHexColour("1a2B3c"), glm::u8vec3(0x1a, 0x2b, 0x3c));
  for (const char* wrong : {"", "12345", "1234567", "12345g", "#12345"})
    EXPECT_THROW(parseHexColour(wrong), UsageError) << wrong;
}

TEST(DrawFlags, BecomeDrawOptions) {
  const DrawFlags flags{.shading = "hq",
                        .classes = "2",
                        .background = "000102,030405",
                        .fill = "5",
                        .range = {10.0, 20.0},
                        .clipBoxes = {{5.0, 6.0, 7.0, 1.0, 2.0, 3.0}},  // corners in any order
                        .clipPlanes = {{1.0, 0.0, 0.0, -4.0}}};
  DrawOptions draw;
  applyDrawFlags(flags, draw);
  EXPECT_EQ(draw.shading, Shading::highQuality);
  EXPECT_EQ(draw.fill, 5);
  EXPECT_EQ(draw.elevationRange, glm::dvec2(10.0, 20.0));
  EXPECT_EQ(draw.intensityRange, glm::vec2(10.0f, 20.0f));
  EXPECT_EQ(draw.classes.count(), 1u);
  EXPECT_EQ(draw.background, glm::u8vec3(0, 1, 2));
  EXPECT_EQ(draw.backgroundBelow, glm::u8vec3(3, 4, 5));
  EXPECT_EQ(draw.clip.boxes.at(0).min, glm::dvec3(1.0, 2.0, 3.0));
  EXPECT_EQ(draw.clip.boxes.at(0).max, glm::dvec3(5.0, 6.0, 7.0));
  EXPECT_EQ(draw.clip.planes.at(0), glm::dvec4(1.0, 0.0, 0.0, -4.0));
}

TEST(DrawFlags, FillByJumpFloodingInPlaceOfAWindow) {
  DrawFlags flags;
  flags.fill = "jump-flood";
  DrawOptions draw;
  applyDrawFlags(flags, draw);
  EXPECT_TRUE(draw.jumpFlood);
  EXPECT_EQ(draw.fill, 1);
}

TEST(DrawFlags, LeaveTheOptionsAloneWhenNoneIsGiven) {
  DrawOptions draw;
  draw.elevationRange = {1.0, 2.0};
  applyDrawFlags({}, draw);
  EXPECT_TRUE(draw.classes.all());
  EXPECT_TRUE(draw.clip.empty());
  EXPECT_EQ(draw.elevationRange, glm::dvec2(1.0, 2.0));
  EXPECT_FALSE(draw.backgroundBelow.has_value());
}

}  // namespace
}  // namespace strata
