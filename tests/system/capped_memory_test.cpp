// Thirty million points are converted in the least memory that --memory allows.
#include "tests/support/programs.h"

namespace strata::test {
namespace {

TEST(CappedMemory, HoldsForThirtyMillionPointsAndManyThreads) {
  const TempFolder folder;
  for (const char* threads : {"2", "8"}) {
    const Json result = mustConvert({"synthetic:city?points=3e7"}, folder / "a.strata",
                                    {"--memory", "512M", "--threads", threads, "--force"});
    EXPECT_EQ(result.at("points"), 30'000'000);
    EXPECT_LE(result.at("peak_rss_bytes").get<std::uint64_t>(), std::uint64_t{512} << 20) << threads << " threads";
  }
  EXPECT_EQ(mustInfo(folder / "a.strata", true).at("bad_nodes"), 0);
}

}  // namespace
}  // namespace strata::test
