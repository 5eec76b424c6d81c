#include "converter/survey/sampled_source.h"
#include "io/open_scans.h"

#include <gtest/gtest.h>

namespace strata {
namespace {

std::uint64_t readAll(const Sources& sources) {
  std::uint64_t points = 0;
  PointBlock block;
  for (const auto& source : sources)
    for (std::size_t part = 0; part < source->partCount(); ++part)
      for (const auto reader = source->openPart(part); reader->read(block, 10000);) points += block.count();
  return points;
}

TEST(SampledSource, TakesAboutAsManyPointsAsAskedFromAllOverTheScan) {
  const Sources whole = openScans({"synthetic:plane?points=40000000"}, {});
  const Sources sampled = sampleSources(whole, 100'000);
  const std::uint64_t points = readAll(sampled);
  EXPECT_GE(points, 90'000u);
  EXPECT_LE(points, 100'000u);
  EXPECT_GE(sampled.front()->partCount(), 20u);
}

TEST(SampledSource, TakesEveryPointOfAScanThatIsSmallerThanAsked) {
  const Sources whole = openScans({"synthetic:plane?points=1500000", "synthetic:sphere?points=3"}, {});
  EXPECT_EQ(readAll(sampleSources(whole, 2'000'000)), 1'500'003u);
}

TEST(SampledSource, TakesOneScanInTwoWhereThereAreTooMany) {
  std::vector<std::string> inputs(200, "synthetic:plane?points=1000");
  const Sources whole = openScans(inputs, {});
  const Sources sampled = sampleSources(whole, 100'000);
  EXPECT_EQ(sampled.size(), 100u);
  EXPECT_EQ(readAll(sampled), 100'000u);
}

TEST(SampledSource, SaysNoMorePointsThanItCanHaveAndKeepsTheFrame) {
  const Sources whole = openScans({"synthetic:city?points=3000000"}, {});
  const Sources sampled = sampleSources(whole, 1000);
  ASSERT_EQ(sampled.size(), 1u);
  EXPECT_EQ(sampled.front()->info().pointCount, readAll(sampled));
  EXPECT_EQ(sampled.front()->info().bounds.min, whole.front()->info().bounds.min);
}

}  // namespace
}  // namespace strata
