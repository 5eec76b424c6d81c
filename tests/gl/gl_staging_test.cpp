#include "render/gl/gl_staging.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/gl_contexts.h"

namespace strata {
namespace {

using test::ContextKind;

constexpr std::uint64_t kHalfBytes = 4096;
constexpr std::size_t kWords = 8192;

/// Sends pieces of random length to random offsets of a buffer, many times as much as the ring holds, and returns the
/// content of the buffer.
void expectAllArrives(const GlFunctions& functions, GlStaging& staging) {
  GlBuffer buffer(functions, kWords * 4, gl::kStaticDraw);
  buffer.fill(0);
  std::vector<std::uint32_t> expected(kWords, 0), found(kWords, 1);
  std::mt19937 random(7);
  for (int piece = 0; piece < 500; ++piece) {
    const std::size_t length = 1 + random() % (piece % 50 == 0 ? 3000 : 400);  // now and then longer than a half
    const std::size_t offset = random() % (kWords - length);
    const std::span<std::uint32_t> room = staging.room(length);
    ASSERT_EQ(room.size(), length);
    for (std::size_t i = 0; i < length; ++i) expected[offset + i] = static_cast<std::uint32_t>(random());
    std::copy_n(expected.begin() + static_cast<std::ptrdiff_t>(offset), length, room.begin());
    staging.send(buffer, offset * 4);
  }
  buffer.read(0, found.data(), kWords * 4);
  EXPECT_EQ(found, expected);
  EXPECT_EQ(functions.GetError(), 0u);
}

class Staging : public testing::TestWithParam<ContextKind> {};

TEST_P(Staging, BringsEveryWordThroughARingThatIsManyTimesUsed) {
  STRATA_REQUIRE_CONTEXT(context, GetParam());
  const GlFunctions functions = loadGlFunctions(*context);
  GlStaging staging(functions, kHalfBytes);
  expectAllArrives(functions, staging);
  if (functions.BufferStorage == nullptr) GTEST_SKIP() << "buffers cannot stay mapped here; plain memory was used";
  EXPECT_TRUE(staging.isMapped());
}

TEST_P(Staging, WorksWhereBuffersCannotStayMapped) {
  STRATA_REQUIRE_CONTEXT(context, GetParam());
  GlFunctions functions = loadGlFunctions(*context);
  functions.BufferStorage = nullptr;
  GlStaging staging(functions, kHalfBytes);
  expectAllArrives(functions, staging);
  EXPECT_FALSE(staging.isMapped());
}

INSTANTIATE_TEST_SUITE_P(All, Staging, testing::Values(ContextKind::egl, ContextKind::osMesa),
                         [](const testing::TestParamInfo<ContextKind>& instance) {
                           return test::contextName(instance.param);
                         });

}  // namespace
}  // namespace strata
