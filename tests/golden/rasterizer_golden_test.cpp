// Pictures of a synthetic town, compared with those in the repository. STRATA_ACCEPT_GOLDEN=1 replaces them; look at
// them before you commit. A picture that differs is written to the folder of temporary files as NAME.actual.png.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "core/image.h"
#include "render/create_rasterizer.h"
#include "tests/support/paths.h"
#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

/// Pixels that may differ by more than kSameColour in a channel. A point on the edge of its pixel falls to one side or
/// the other with and without fused multiply-add, and dilation makes four pixels of it.
constexpr double kMaxDifferentPart = 0.002;
constexpr int kSameColour = 2;  ///< exp and log2 of the mathematics library differ in their last bits

double differentPart(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height) return 1.0;
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    int largest = 0;
    for (int shift = 0; shift < 24; shift += 8)
      largest = std::max(largest, std::abs(static_cast<int>(a.pixels[i] >> shift & 255u) -
                                           static_cast<int>(b.pixels[i] >> shift & 255u)));
    different += largest > kSameColour;
  }
  return static_cast<double>(different) / static_cast<double>(a.pixels.size());
}

void expectGolden(const std::string& name, const DrawOptions& options) {
  const RenderList list = test::makeTown(glm::dvec3(456789.0, 5412345.0, 300.0), 100.0, 150000, 1, 4);
  View view = viewOfBox(test::boundsOf(list), {1.0, 0.83, -0.6}, 320, 240, 1.0);
  view.target = {456789.0, 5412345.0, 300.0};
  view.eye = view.target + (view.eye - view.target) * 0.45;
  Picture picture;
  createRasterizer(Backend::cpu, {}, nullptr)->draw(list, view, options, picture);
  const Image actual{picture.width, picture.height, picture.colour};
  const std::string path = (test::sourceFolder() / "tests/golden" / (std::string(name) + ".png")).string();
  if (std::getenv("STRATA_ACCEPT_GOLDEN") != nullptr) writePng(path, actual);
  const double different = differentPart(actual, readPng(path));
  EXPECT_LE(different, kMaxDifferentPart) << name;
  if (different > kMaxDifferentPart)
    writePng((std::filesystem::temp_directory_path() / (name + ".actual.png")).string(), actual);
}

TEST(RasterizerGolden, ColoursWithPointsOfOnePixel) { expectGolden("town_rgb", {}); }

TEST(RasterizerGolden, ElevationWithEyeDomeLighting) {
  DrawOptions options;
  options.colour = ColourMode::elevation;
  options.elevationRange = {295.0, 320.0};
  options.pointSize = 2;
  options.edl = true;
  expectGolden("town_elevation_edl", options);
}

TEST(RasterizerGolden, LevelsWithLargePoints) {
  DrawOptions options;
  options.colour = ColourMode::level;
  options.pointSize = 4;
  expectGolden("town_level_size4", options);
}

TEST(RasterizerGolden, HighQualityShadingOverAGradient) {
  DrawOptions options;
  options.shading = Shading::highQuality;
  options.pointSize = 2;
  options.background = {40, 60, 110};
  options.backgroundBelow = glm::u8vec3(190, 200, 215);
  expectGolden("town_high_quality", options);
}

TEST(RasterizerGolden, ClassesOfAClipBoxWithItsHolesFilled) {
  DrawOptions options;
  options.colour = ColourMode::classification;
  options.fill = 5;
  options.edl = true;
  options.classes.reset();
  for (const std::size_t wanted : {2u, 5u, 6u, 9u}) options.classes.set(wanted);
  options.clip.boxes = {{{456759.0005, 5412305.0005, 290.0}, {456819.0005, 5412365.0005, 340.0}}};
  expectGolden("town_clip_fill", options);
}

TEST(RasterizerGolden, HolesFilledByJumpFlooding) {
  DrawOptions options;
  options.jumpFlood = true;
  options.edl = true;
  expectGolden("town_jump_flood", options);
}

TEST(RasterizerGolden, Overdraw) {
  DrawOptions options;
  options.colour = ColourMode::overdraw;
  expectGolden("town_overdraw", options);
}

}  // namespace
}  // namespace strata
