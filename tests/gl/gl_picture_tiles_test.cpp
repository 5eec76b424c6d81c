// A picture drawn in tiles by OpenGL equals the picture drawn whole.
#include "render/create_rasterizer.h"
#include "render/gpu/compute_rasterizer.h"
#include "tests/support/gl_contexts.h"
#include "tests/support/tiled_picture.h"

namespace strata {
namespace {

const bool kOffered = (test::offerWideAtomicsInSoftware(), true);

TEST(GlPictureTiles, MakeTheWholePixelForPixelWithEveryEffectByEveryWay) {
  for (const Backend backend : {Backend::compute64, Backend::compute32, Backend::computeLock, Backend::points}) {
    STRATA_REQUIRE_CONTEXT(context, test::ContextKind::egl);
    if (backend == Backend::compute64 && !hasWideAtomics(*context)) continue;
    const auto rasterizer = createRasterizer(backend, {}, std::move(context));
    test::expectTilesMakeTheWhole(*rasterizer, 1);
  }
}

}  // namespace
}  // namespace strata
