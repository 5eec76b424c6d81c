// Ten small views of three scans, and one at full HD, compared with the oracle.
#include <gtest/gtest.h>

#include "render/create_rasterizer.h"
#include "tests/support/oracle.h"
#include "tests/support/scan_lists.h"
#include "tests/support/test_data.h"

namespace strata {
namespace {

constexpr std::size_t kMostPoints = 400000;

void expectOraclesPictures(const std::string& input) {
  const RenderList list = test::listOfScan(input, kMostPoints);
  ASSERT_GT(list.pointCount, 1000u);
  std::vector<View> views = test::viewsAround(test::boundsOf(list), 10, 512, 512);
  views.push_back(test::viewsAround(test::boundsOf(list), 2, 1920, 1080)[1]);
  const auto cpu = createRasterizer(Backend::cpu, {}, nullptr);
  for (const View& view : views) {
    Picture picture, again;
    cpu->draw(list, view, {}, picture);
    const test::Comparison result = test::compareToOracle(list, view, picture);
    EXPECT_GE(result.agreement(), 0.999) << result.different << " of " << result.covered << " pixels differ";
    EXPECT_EQ(result.unexplained, 0u) << result.firstUnexplained;
    cpu->draw(list, view, {}, again);
    EXPECT_EQ(picture.pointId, again.pointId);
    EXPECT_EQ(picture.depth, again.depth);
    EXPECT_EQ(picture.colour, again.colour);
  }
}

TEST(CpuOnScans, GivesTheOraclesPicturesOfACity) { expectOraclesPictures("synthetic:city?points=4e5&seed=3"); }
TEST(CpuOnScans, GivesTheOraclesPicturesOfARoom) { expectOraclesPictures("synthetic:room?points=4e5&seed=3"); }
TEST(CpuOnScans, GivesTheOraclesPicturesOfATerrain) { expectOraclesPictures("synthetic:terrain?points=4e5&seed=3"); }

TEST(CpuOnScans, GivesTheOraclesPicturesOfRealScans) {
  STRATA_REQUIRE_DATA();
  for (const char* file : {"laz/lion/r.laz", "laz/real/ahn3_cropped_1.laz", "laz/red-rocks-tiles/0-0-0-0.laz"})
    expectOraclesPictures((test::dataFolder() / file).string());
}

}  // namespace
}  // namespace strata
