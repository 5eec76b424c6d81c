// DrawOptions in shaders, and several views at once, compared with the cpu rasterizer; and what happens where the
// driver cannot do something.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>

#include "render/create_rasterizer.h"
#include "render/gpu/compute_rasterizer.h"
#include "tests/support/gl_contexts.h"
#include "tests/support/oracle.h"
#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

using test::ContextKind;

const bool kOffered = (test::offerWideAtomicsInSoftware(), true);
const glm::dvec3 kUtm(456789.123, 5412345.678, 312.5);
const glm::dvec3 kDirection(1.0, 0.83, -0.71);

class GlOptions : public testing::TestWithParam<Backend> {
 protected:
  bool create(const RasterizerOptions& options = {}) {
    std::string reason;
    auto context = test::tryContext(ContextKind::egl, reason);
    if (context == nullptr || (GetParam() == Backend::compute64 && !hasWideAtomics(*context))) return false;
    rasterizer_ = createRasterizer(GetParam(), options, std::move(context));
    return true;
  }
  bool isCompute() const { return GetParam() != Backend::points; }

  /// Expects the picture of the cpu, except for points that fall to the other side of a pixel's edge. Colours that
  /// differ by at most `alike` of 255 count as equal.
  void expectTheCpusPicture(const View& view, const DrawOptions& options, double mostOther = 0.002, int alike = 0) {
    const auto cpu = createRasterizer(Backend::cpu, {}, nullptr);
    Picture expected, picture;
    cpu->draw(list_, view, options, expected);
    rasterizer_->draw(list_, view, options, picture);
    std::size_t covered = 0, otherIds = 0, otherColours = 0;
    for (std::size_t i = 0; i < expected.pointId.size(); ++i) {
      covered += expected.pointId[i] != Picture::kNoPoint;
      const bool same = expected.pointId[i] == picture.pointId[i];
      otherIds += !same;
      for (int shift = 0; same && shift < 24; shift += 8) {
        const int apart =
            static_cast<int>(expected.colour[i] >> shift & 255u) - static_cast<int>(picture.colour[i] >> shift & 255u);
        if (std::abs(apart) <= alike) continue;
        ++otherColours;
        break;
      }
    }
    EXPECT_GT(covered, 1000u);
    EXPECT_LE(static_cast<double>(otherIds), mostOther * static_cast<double>(covered));
    EXPECT_LE(static_cast<double>(otherColours), mostOther * static_cast<double>(covered));
  }

  const RenderList list_ = test::makeTown(kUtm, 200.0, 100000, 5);
  const View view_ = viewOfBox(test::boundsOf(list_), kDirection, 512, 512, 1.0);
  std::unique_ptr<Rasterizer> rasterizer_;
};

#define STRATA_CREATE_OR_SKIP(...) \
  if (!create(__VA_ARGS__)) GTEST_SKIP() << "no such context here"

TEST_P(GlOptions, ColourPixelsInEveryMode) {
  STRATA_CREATE_OR_SKIP();
  DrawOptions options;
  options.elevationRange = {300.0, 350.0};
  for (const ColourMode mode :
       {ColourMode::rgb, ColourMode::intensity, ColourMode::elevation, ColourMode::classification, ColourMode::level,
        ColourMode::returnNumber, ColourMode::normal, ColourMode::precision, ColourMode::overdraw}) {
    options.colour = mode;
    expectTheCpusPicture(view_, options);
  }
}

TEST_P(GlOptions, ClipPointsByBoxesAndPlanes) {
  STRATA_CREATE_OR_SKIP();
  DrawOptions options;
  options.clip.boxes.push_back({kUtm - glm::dvec3(60.0, 80.0, 5.0), kUtm + glm::dvec3(10.0, 20.0, 12.0)});
  options.clip.boxes.push_back({kUtm + glm::dvec3(20.0, 20.0, -50.0), kUtm + glm::dvec3(90.0, 70.0, 50.0)});
  expectTheCpusPicture(view_, options);
  options.clip.planes.push_back(glm::dvec4(0.6, 0.0, 0.8, -glm::dot(glm::dvec3(0.6, 0.0, 0.8), kUtm)));
  expectTheCpusPicture(view_, options);
  options.clip.boxes.clear();
  expectTheCpusPicture(view_, options);
}

TEST_P(GlOptions, LeaveOutWhatIsInACutout) {
  STRATA_CREATE_OR_SKIP();
  DrawOptions options;
  options.clip.cutouts.push_back({kUtm - glm::dvec3(60.0, 80.0, 5.0), kUtm + glm::dvec3(10.0, 20.0, 12.0)});
  expectTheCpusPicture(view_, options);
  options.clip.boxes.push_back({kUtm - glm::dvec3(70.0, 70.0, 50.0), kUtm + glm::dvec3(90.0, 70.0, 50.0)});
  options.clip.cutouts.push_back({kUtm + glm::dvec3(20.0, 20.0, -50.0), kUtm + glm::dvec3(50.0, 70.0, 50.0)});
  expectTheCpusPicture(view_, options);
}

TEST_P(GlOptions, DrawOnlyTheClassesAskedFor) {
  STRATA_CREATE_OR_SKIP();
  DrawOptions options;
  expectTheCpusPicture(view_, options);  // uploads without classes
  options.classes.reset();
  for (const int kept : {2, 5, 6, 17}) options.classes.set(static_cast<std::size_t>(kept));
  expectTheCpusPicture(view_, options);
  options.clip.planes.push_back(glm::dvec4(0.6, 0.0, 0.8, -glm::dot(glm::dvec3(0.6, 0.0, 0.8), kUtm)));
  expectTheCpusPicture(view_, options);
}

TEST_P(GlOptions, BlendPointsNearTheFront) {
  STRATA_CREATE_OR_SKIP();
  if (!isCompute()) GTEST_SKIP() << "points draws without";
  DrawOptions options;
  options.shading = Shading::highQuality;
  const View far = [this] {
    View view = viewOfBox(test::boundsOf(list_), kDirection, 200, 200, 1.0);
    view.eye += 0.5 * (view.eye - view.target);
    return view;
  }();
  for (const ColourMode mode : {ColourMode::rgb, ColourMode::intensity, ColourMode::precision, ColourMode::rgb}) {
    options.colour = mode;
    expectTheCpusPicture(far, options, 0.01);
  }
}

/// A looser comparison, because one point in another pixel changes the splats around it, and shaders blend in integers.
TEST_P(GlOptions, FillHolesByJumpFlooding) {
  STRATA_CREATE_OR_SKIP();
  View view = view_;
  view.eye = view.target + (view.eye - view.target) * 0.4;
  DrawOptions options;
  options.jumpFlood = true;
  expectTheCpusPicture(view, options, 0.01, 2);
}

TEST_P(GlOptions, LeaveOutNodesBelowTheGazesThreshold) {
  STRATA_CREATE_OR_SKIP();
  DrawOptions options;
  options.gaze = {true, {0.3f, 0.5f}, 150.0f, 400.0f};
  expectTheCpusPicture(view_, options);
}

TEST_P(GlOptions, DrawTwoEyesAtOnceAsOneAfterTheOther) {
  STRATA_CREATE_OR_SKIP();
  View left = view_, right = view_;
  right.eye += glm::dvec3(0.4, -0.3, 0.1);
  right.target += glm::dvec3(0.4, -0.3, 0.1);
  right.width = 300;
  for (const Shading shading : {Shading::plain, Shading::highQuality}) {
    DrawOptions options;
    options.shading = shading;
    options.gaze = {true, {0.3f, 0.5f}, 50.0f, 200.0f};
    options.clip.planes.push_back(glm::dvec4(0.6, 0.0, 0.8, -glm::dot(glm::dvec3(0.6, 0.0, 0.8), kUtm)));
    const View views[] = {left, right};
    Picture both[2], one;
    const DrawStats stats = rasterizer_->drawViews(list_, views, options, both);
    std::uint64_t points = 0;
    for (int v = 0; v < 2; ++v) {
      points += rasterizer_->draw(list_, views[v], options, one).pointsDrawn;
      EXPECT_EQ(one.pointId, both[v].pointId);
      EXPECT_EQ(one.depth, both[v].depth);
      EXPECT_EQ(one.colour, both[v].colour);
    }
    EXPECT_EQ(stats.pointsDrawn, points);
  }
}

TEST_P(GlOptions, CountAsTheCpuDoes) {
  STRATA_CREATE_OR_SKIP();
  const auto cpu = createRasterizer(Backend::cpu, {}, nullptr);
  View close = view_;
  close.eye = close.target + 0.05 * (close.eye - close.target);
  for (const View& view : {view_, close}) {
    Picture picture;
    const DrawStats expected = cpu->draw(list_, view, {}, picture), stats = rasterizer_->draw(list_, view, {}, picture);
    EXPECT_EQ(stats.pointsDrawn, expected.pointsDrawn);
    EXPECT_EQ(stats.batchesDrawn, expected.batchesDrawn);
    EXPECT_EQ(stats.batchesCulled, expected.batchesCulled);
    for (int p = 0; p < 3; ++p) EXPECT_EQ(stats.batchesAt[p], expected.batchesAt[p]);
  }
}

std::string backendName(const testing::TestParamInfo<Backend>& instance) {
  constexpr const char* kNames[] = {"Automatic", "Cpu", "Compute32", "Compute64", "ComputeLock", "Points"};
  return kNames[static_cast<int>(instance.param)];
}

INSTANTIATE_TEST_SUITE_P(All, GlOptions,
                         testing::Values(Backend::compute64, Backend::compute32, Backend::computeLock, Backend::points),
                         backendName);

TEST(ComputeLock, FinishesThePictureWhereALockStaysTaken) {
  const RenderList list = test::makeTown(kUtm, 200.0, 100000, 5);
  const View view = viewOfBox(test::boundsOf(list), kDirection, 512, 512, 1.0);
  for (const std::uint32_t turns : {0u, 1u, 256u}) {  // 0: every point gives up
    STRATA_REQUIRE_CONTEXT(context, ContextKind::egl);
    ComputeExperiment experiment;
    experiment.lockTurns = turns;
    const auto rasterizer = createComputeRasterizer(ComputeWay::computeLock, std::move(context), {}, experiment);
    Picture picture;
    const DrawStats stats = rasterizer->draw(list, view, {}, picture);
    const test::Comparison result = test::compareToOracle(list, view, picture);
    EXPECT_GE(result.agreement(), 0.999) << turns;
    EXPECT_EQ(result.unexplained, 0u) << result.firstUnexplained;
    EXPECT_TRUE(turns > 0 || stats.lockRepairs == 1u);
  }
}

TEST(Compute64, DrawsTheSameWithoutPrefetch) {
  STRATA_REQUIRE_CONTEXT(context, ContextKind::egl);
  STRATA_REQUIRE_CONTEXT(other, ContextKind::egl);
  if (!hasWideAtomics(*context)) GTEST_SKIP() << "no 64-bit atomics here";
  const RenderList list = test::makeTown(kUtm, 200.0, 100000, 5);
  const View view = viewOfBox(test::boundsOf(list), kDirection, 512, 512, 1.0);
  ComputeExperiment basic;
  basic.prefetch = false;
  const auto one = createComputeRasterizer(ComputeWay::compute64, std::move(context), {}, basic);
  const auto four = createComputeRasterizer(ComputeWay::compute64, std::move(other), {});
  Picture a, b;
  one->draw(list, view, {}, a);
  four->draw(list, view, {}, b);
  EXPECT_EQ(a.pointId, b.pointId);
  EXPECT_EQ(a.depth, b.depth);
}

/// A context that takes its functions from another, except for some.
class ChangedContext final : public GlContext {
 public:
  using Change = Function (*)(const char* name, Function original);
  ChangedContext(std::unique_ptr<GlContext> context, Change change) : context_(std::move(context)), change_(change) {}
  void makeCurrent() override { context_->makeCurrent(); }
  Function getProc(const char* name) override { return change_(name, context_->getProc(name)); }

 private:
  std::unique_ptr<GlContext> context_;
  Change change_;
};

const unsigned char* (*realGetStringi)(unsigned, unsigned) = nullptr;
const unsigned char* withoutAtomics(unsigned name, unsigned index) {
  const unsigned char* text = realGetStringi(name, index);
  const bool hidden = text != nullptr && std::strstr(reinterpret_cast<const char*>(text), "shader_atomic_int64");
  return hidden ? reinterpret_cast<const unsigned char*>("GL_nothing") : text;
}

std::unique_ptr<GlContext> hideAtomics(std::unique_ptr<GlContext> context) {
  return std::make_unique<ChangedContext>(std::move(context), [](const char* name, GlContext::Function original) {
    if (std::strcmp(name, "glGetStringi") != 0) return original;
    realGetStringi = reinterpret_cast<decltype(realGetStringi)>(original);
    return reinterpret_cast<GlContext::Function>(&withoutAtomics);
  });
}

TEST(Compute64, SaysWhatTheDriverLacks) {
  STRATA_REQUIRE_CONTEXT(context, ContextKind::egl);
  try {
    createRasterizer(Backend::compute64, {}, hideAtomics(std::move(context)));
    FAIL() << "made";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("GL_NV_shader_atomic_int64"), std::string::npos) << error.what();
  }
}

constexpr std::ptrdiff_t kRoom = 1500000;  ///< bytes that the driver of the next test has for one buffer
void (*realBufferData)(unsigned, std::ptrdiff_t, const void*, unsigned) = nullptr;
unsigned (*realGetError)() = nullptr;
bool outOfMemory = false;
void scarceBufferData(unsigned target, std::ptrdiff_t bytes, const void* data, unsigned usage) {
  if (bytes > kRoom)
    outOfMemory = true;
  else
    realBufferData(target, bytes, data, usage);
}
unsigned scarceGetError() {
  const unsigned error = outOfMemory ? 0x0505 : realGetError();
  outOfMemory = false;
  return error;
}

TEST(GlRasterizers, TakeASmallerPoolWhereTheGpuHasNoMemory) {
  STRATA_REQUIRE_CONTEXT(context, ContextKind::egl);
  auto scarce = std::make_unique<ChangedContext>(
      std::move(context), [](const char* name, GlContext::Function original) -> GlContext::Function {
        if (std::strcmp(name, "glBufferData") == 0) {
          realBufferData = reinterpret_cast<decltype(realBufferData)>(original);
          return reinterpret_cast<GlContext::Function>(&scarceBufferData);
        }
        if (std::strcmp(name, "glGetError") == 0) {
          realGetError = reinterpret_cast<decltype(realGetError)>(original);
          return reinterpret_cast<GlContext::Function>(&scarceGetError);
        }
        return original;
      });
  const auto rasterizer = createRasterizer(Backend::compute32, {}, std::move(scarce));
  const RenderList list = test::makeTown(kUtm, 200.0, 100000, 5);
  const View view = viewOfBox(test::boundsOf(list), kDirection, 512, 512, 1.0);
  Picture picture;
  const DrawStats stats = rasterizer->draw(list, view, {}, picture);
  EXPECT_EQ(stats.nodesNotUploaded, 0u);
  EXPECT_GT(stats.gpuBytes, 1000000u);
  const test::Comparison result = test::compareToOracle(list, view, picture);
  EXPECT_EQ(result.unexplained, 0u) << result.firstUnexplained;
}

TEST(GlRasterizers, DrawTheSmallestAndTheLargestImage) {
  const RenderList list = test::makeTown(kUtm, 200.0, 20000, 5);
  for (const Backend backend : {Backend::compute64, Backend::compute32, Backend::computeLock, Backend::points}) {
    STRATA_REQUIRE_CONTEXT(context, ContextKind::egl);
    if (backend == Backend::compute64 && !hasWideAtomics(*context)) continue;
    const auto rasterizer = createRasterizer(backend, {}, std::move(context));
    Picture picture;
    const View dot = viewOfBox(test::boundsOf(list), kDirection, 1, 1, 1.0);
    rasterizer->draw(list, dot, {}, picture);
    EXPECT_EQ(test::compareToOracle(list, dot, picture).unexplained, 0u);
  }
}

}  // namespace
}  // namespace strata
