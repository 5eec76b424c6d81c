#include "render/gl/gl_context.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "render/create_rasterizer.h"
#include "render/gl/gl_objects.h"
#include "render/gpu/compute_rasterizer.h"
#include "tests/support/gl_contexts.h"
#include "tests/support/oracle.h"
#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

using test::ContextKind;

class GlContexts : public testing::TestWithParam<ContextKind> {};

TEST_P(GlContexts, LoadEveryFunctionOfTheTable) {
  STRATA_REQUIRE_CONTEXT(context, GetParam());
  const GlFunctions functions = loadGlFunctions(*context);
  EXPECT_NE(glRenderer(functions), "unknown");
}

TEST_P(GlContexts, NameTheFileAndTheLineOfAShadersError) {
  STRATA_REQUIRE_CONTEXT(context, GetParam());
  const GlFunctions functions = loadGlFunctions(*context);
  try {
    // Without shader_types.h, the first binding of batch.glsl has no number. It is on line 2.
    const GlProgram program(functions, {{gl::kComputeShader, {"points.frag", "batch.glsl"}}});
    FAIL() << "compiled";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("batch.glsl:2("), std::string::npos) << error.what();
  }
}

TEST_P(GlContexts, LeaveSoftwareRenderingToTheCpu) {
  STRATA_REQUIRE_CONTEXT(context, GetParam());
  const bool software = isSoftwareRenderer(glRenderer(loadGlFunctions(*context)));
  const std::string fastest = hasWideAtomics(*context) ? "compute64" : "compute32";
  EXPECT_EQ(createRasterizer(Backend::automatic, {}, std::move(context))->name(), software ? "cpu" : fastest);
}

INSTANTIATE_TEST_SUITE_P(All, GlContexts, testing::Values(ContextKind::egl, ContextKind::osMesa),
                         [](const testing::TestParamInfo<ContextKind>& instance) {
                           return test::contextName(instance.param);
                         });

TEST(GlContextPair, DrawsByTurnsInOneThread) {
  STRATA_REQUIRE_CONTEXT(egl, ContextKind::egl);
  STRATA_REQUIRE_CONTEXT(osMesa, ContextKind::osMesa);
  const RenderList list = test::makeTown(glm::dvec3(0.0), 100.0, 20000, 1);
  const View view = viewOfBox(test::boundsOf(list), {1.0, 0.83, -0.71}, 256, 256, 1.0);
  const auto first = createRasterizer(Backend::compute32, {}, std::move(egl));
  auto second = createRasterizer(Backend::points, {}, std::move(osMesa));
  Picture a, b, again;
  first->draw(list, view, {}, a);
  second->draw(list, view, {}, b);
  second.reset();
  first->draw(list, view, {}, again);
  EXPECT_EQ(a.pointId, again.pointId);
  EXPECT_EQ(test::compareToOracle(list, view, b).unexplained, 0u);
}

TEST(GlContext, WithoutFunctionsIsRefused) {
  const auto context = adoptCurrentContext([](const char*) -> GlContext::Function { return nullptr; });
  EXPECT_THROW(loadGlFunctions(*context), Error);
  EXPECT_EQ(createRasterizer(Backend::automatic, {},
                             adoptCurrentContext([](const char*) -> GlContext::Function { return nullptr; }))
                ->name(),
            "cpu");
}

TEST(ShaderErrors, GetTheNamesOfTheirFiles) {
  const std::vector<std::string_view> files{"a.h", "b.comp"};
  EXPECT_EQ(nameShaderFiles("0:10020(3): error: x\n0(7) : error C1: y\nsummary\n0:90001: z", files),
            "b.comp:20(3): error: x\na.h:7) : error C1: y\nsummary\n0:90001: z");
  EXPECT_THROW(shaderText("none.comp"), Error);
}

}  // namespace
}  // namespace strata
