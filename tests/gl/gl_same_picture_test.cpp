// Every rasterizer that uses OpenGL, compared with the oracle on scans.
#include <gtest/gtest.h>

#include "render/create_rasterizer.h"
#include "render/gpu/compute_rasterizer.h"
#include "tests/support/gl_contexts.h"
#include "tests/support/oracle.h"
#include "tests/support/scan_lists.h"
#include "tests/support/synthetic_nodes.h"
#include "tests/support/test_data.h"

namespace strata {
namespace {

const bool kOffered = (test::offerWideAtomicsInSoftware(), true);

constexpr std::size_t kMostPoints = 300000;

/// Three real scans: one from the air, one from photographs of a hillside, one of a statue. Synthetic scans replace
/// those that are absent.
std::string scanNamed(const std::string& name) {
  if (test::dataFolder().empty())
    return "synthetic:" +
           std::string(name == "airborne"   ? "city"
                       : name == "hillside" ? "terrain"
                                            : "room") +
           "?points=300000";
  const std::string file = name == "airborne"   ? "laz/real/ahn3_cropped_1.laz"
                           : name == "hillside" ? "laz/red-rocks-tiles/0-0-0-0.laz"
                                                : "laz/lion/r.laz";
  return (test::dataFolder() / file).string();
}

class SamePicture : public testing::TestWithParam<const char*> {
 protected:
  /// Draws ten views at 512 x 512 pixels and one at 1920 x 1080.
  static std::vector<View> elevenViews(const Box& box) {
    std::vector<View> views = test::viewsAround(box, 10, 512, 512);
    views.push_back(test::viewsAround(box, 2, 1920, 1080).front());
    return views;
  }
};

TEST_P(SamePicture, AsTheOraclesByEveryWay) {
  const RenderList list = test::listOfScan(scanNamed(GetParam()), kMostPoints);
  const std::vector<View> views = elevenViews(test::boundsOf(list));
  for (const Backend backend : {Backend::compute64, Backend::compute32, Backend::computeLock, Backend::points}) {
    STRATA_REQUIRE_CONTEXT(context, test::ContextKind::egl);
    if (backend == Backend::compute64 && !hasWideAtomics(*context)) continue;
    const auto rasterizer = createRasterizer(backend, {}, std::move(context));
    // The points rasterizer settles a tie by the order of drawing.
    const double wanted = backend == Backend::points ? 0.995 : 0.999;
    std::uint64_t covered = 0, different = 0;
    for (const View& view : views) {
      Picture picture;
      rasterizer->draw(list, view, {}, picture);
      const test::Comparison result = test::compareToOracle(list, view, picture);
      EXPECT_GE(result.agreement(), wanted) << result.different << " of " << result.covered << " differ";
      EXPECT_EQ(result.unexplained, 0u) << result.firstUnexplained;
      covered += result.covered;
      different += result.different;
    }
    EXPECT_GT(covered, 30000u);
    std::printf("%s, %s: %llu of %llu covered pixels differ\n", GetParam(), rasterizer->name().data(),
                static_cast<unsigned long long>(different), static_cast<unsigned long long>(covered));
  }
}

INSTANTIATE_TEST_SUITE_P(Scans, SamePicture, testing::Values("airborne", "hillside", "statue"),
                         [](const testing::TestParamInfo<const char*>& instance) { return instance.param; });

}  // namespace
}  // namespace strata
