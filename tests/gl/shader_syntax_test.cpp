// Compiles the shaders with Khronos' reference compiler, where it is installed. Other drivers may refuse what Mesa
// takes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "render/flood/gl_flood.h"
#include "render/gl/gl_objects.h"
#include "render/gl/shader_variant.h"
#include "tests/support/test_data.h"

namespace strata {
namespace {

const std::string kBits32 = define("STRATA_GROUP_SIZE", "128") + define("STRATA_PREFETCH", "1") +
                            define("STRATA_LOCK_TURNS", "256u") + define("STRATA_PLAN_SIZE", "32") +
                            define("STRATA_PX_AT_10_BITS", "500.0LF") + define("STRATA_PX_AT_20_BITS", "512000.0LF") +
                            define("STRATA_DEPTH_STRIDE", "2");

/// The messages of the compiler about one stage; empty where nothing is wrong.
std::string errorsOf(const std::string& kind, int version, const std::string& preamble,
                     const std::vector<std::string_view>& files) {
  const test::TempFolder folder;
  const std::string source = (folder / ("shader." + kind)).string(), log = (folder / "log").string();
  std::ofstream out(source);
  out << "#version " << version << " core\n" << preamble;
  for (const std::string_view file : files) out << shaderText(file);
  out.close();
  const int status = std::system(("glslangValidator -S " + kind + " " + source + " > " + log).c_str());
  std::ifstream in(log);
  return status == 0 ? "" : std::string(std::istreambuf_iterator<char>(in), {});
}

class ShaderSyntax : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("glslangValidator --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no glslangValidator here";
  }
  /// Calls check(defines) for one and two views, with and without a clip region and classes.
  template <typename Check>
  static void forEachVariant(Check check) {
    for (const int views : {1, 2})
      for (const bool clip : {false, true})
        for (const bool classes : {false, true}) check(kBits32 + ShaderVariant{views, clip, classes}.defines());
  }
};

TEST_F(ShaderSyntax, OfTheComputeShadersIsSound) {
  forEachVariant([](const std::string& defines) {
    EXPECT_EQ(errorsOf("comp", 430, defines, {"shader_types.h", "plan.comp"}), "");
    for (const char* count : {"0", "1"})
      for (const std::string_view file : {"compute32.comp", "compute_lock.comp", "accumulate.comp"})
        EXPECT_EQ(errorsOf("comp", 430, defines + define("STRATA_COUNT", count),
                           {"shader_types.h", "batch.glsl", "draw_batch.glsl", file}),
                  "");
  });
}

TEST_F(ShaderSyntax, OfProgressiveDrawingIsSound) {
  forEachVariant([](const std::string& defines) {
    for (const char* pass : {"0", "1", "2"})
      for (const char* oneGrid : {"0", "1"})
        EXPECT_EQ(errorsOf("comp", 430, defines + define("STRATA_PASS", pass) + define("STRATA_ONE_GRID", oneGrid),
                           {"shader_types.h", "batch.glsl", "progressive.comp"}),
                  "");
    for (const std::string_view file : {"pool_insert.comp", "pool_fetch.comp"})
      EXPECT_EQ(errorsOf("comp", 430, defines, {"shader_types.h", "pool.glsl", file}), "");
  });
}

TEST_F(ShaderSyntax, OfFillingHolesIsSound) {
  for (const std::string_view file :
       {"flood_project.comp", "flood_spread.comp", "flood_layers.comp", "flood_neighbours.comp", "flood_splats.comp",
        "flood_draw.comp", "flood_finish.comp"})
    EXPECT_EQ(errorsOf("comp", 430, floodDefines(64), {"shader_types.h", "flood.glsl", file}), "");
}

TEST_F(ShaderSyntax, OfCompute64IsSoundByEitherNameOfItsAtomics) {
  for (const char* atomics : {"GL_NV_shader_atomic_int64", "GL_EXT_shader_atomic_int64"})
    forEachVariant([&](const std::string& defines) {
      const std::string extensions =
          "#extension GL_ARB_gpu_shader_int64 : require\n#extension " + std::string(atomics) + " : require\n";
      EXPECT_EQ(errorsOf("comp", 450, extensions + defines,
                         {"shader_types.h", "batch.glsl", "draw_batch.glsl", "compute64.comp"}),
                "");
    });
}

TEST_F(ShaderSyntax, OfPointsIsSound) {
  forEachVariant([](const std::string& defines) {
    EXPECT_EQ(errorsOf("vert", 430, defines, {"shader_types.h", "batch.glsl", "points.vert"}), "");
  });
  for (const char* count : {"0", "1"})
    EXPECT_EQ(errorsOf("frag", 430, define("STRATA_COUNT", count), {"shader_types.h", "points.frag"}), "");
}

TEST_F(ShaderSyntax, OfAWrongShaderIsNot) {
  EXPECT_NE(errorsOf("comp", 430, kBits32, {"shader_types.h", "compute64.comp"}), "");
}

}  // namespace
}  // namespace strata
