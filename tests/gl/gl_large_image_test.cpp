// Pictures larger than a storage block are drawn band by band, or refused with a warning.
#include <gtest/gtest.h>

#include "render/create_rasterizer.h"
#include "render/gpu/compute_rasterizer.h"
#include "tests/support/gl_contexts.h"
#include "tests/support/oracle.h"
#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

const bool kOffered = (test::offerWideAtomicsInSoftware(), true);

TEST(GlLargeImage, Of8192TimesAsManyIsTheOraclesByEveryWay) {
  const RenderList list = test::makeTown(glm::dvec3(456789.123, 5412345.678, 312.5), 200.0, 50000, 10);
  const View view = viewOfBox(test::boundsOf(list), {1.0, 0.83, -0.71}, 8192, 8192, 1.0);
  Picture picture;
  for (const Backend backend : {Backend::compute64, Backend::compute32, Backend::computeLock, Backend::points}) {
    STRATA_REQUIRE_CONTEXT(context, test::ContextKind::egl);
    if (backend == Backend::compute64 && !hasWideAtomics(*context)) continue;
    const auto rasterizer = createRasterizer(backend, {}, std::move(context));
    rasterizer->draw(list, view, {}, picture);
    const test::Comparison result = test::compareToOracle(list, view, picture);
    EXPECT_GT(result.covered, 10000u);
    EXPECT_GE(result.agreement(), backend == Backend::points ? 0.995 : 0.999) << rasterizer->name();
    EXPECT_EQ(result.unexplained, 0u) << result.firstUnexplained;
  }
}

}  // namespace
}  // namespace strata
