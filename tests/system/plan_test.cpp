// `strata-convert --plan` says what a conversion will need, without converting.
#include "tests/support/programs.h"

namespace strata::test {
namespace {

namespace fs = std::filesystem;

Json mustPlan(const std::vector<std::string>& arguments) {
  std::vector<std::string> all = arguments;
  all.insert(all.end(), {"--plan", "--json"});
  const Finished finished = runProgram("strata-convert", all);
  EXPECT_EQ(finished.exitCode, 0) << finished.err;
  return lastLine(finished);
}

TEST(Plan, NeedsNoOutputAndLeavesNothingBehind) {
  const TempFolder folder;
  const Json plan = mustPlan({"synthetic:room?points=100000", "--temp", folder.path().string()});
  EXPECT_EQ(plan.at("points"), 100000);
  EXPECT_EQ(plan.at("sampled_points"), 100000);
  EXPECT_TRUE(plan.at("warnings").empty());
  for (const char* key : {"bounds", "crs", "store_bytes", "temp_bytes", "memory_bytes", "seconds"})
    EXPECT_TRUE(plan.contains(key)) << key;
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Plan, TellsTheSizeOfTheStoreWithinAFifth) {
  const TempFolder folder;
  // Equal points take fewer bytes each the more there are, so that the plan, which looks at a sample, is too high.
  const std::pair<const char*, double> kInputs[] = {{"synthetic:city?points=4000000", 0.2},
                                                    {"synthetic:terrain?points=4000000", 0.2},
                                                    {"synthetic:sphere?points=3000000", 0.2},
                                                    {"synthetic:degenerate?points=3000000", 0.5}};
  for (const auto& [input, tolerance] : kInputs) {
    SCOPED_TRACE(input);
    const Json plan = mustPlan({input, "--temp", folder.path().string()});
    const Json done = mustConvert({input}, folder / "a.strata", {"--force"});
    EXPECT_LT(plan.at("sampled_points"), 2'000'000);
    EXPECT_EQ(plan.at("points"), done.at("points"));
    EXPECT_NEAR(plan.at("store_bytes").get<double>() / done.at("output_bytes").get<double>(), 1.0, tolerance);
  }
}

TEST(Plan, RefusesWhatAConversionWouldRefuse) {
  const TempFolder folder;
  std::ofstream(folder / "empty.las") << "LASF";
  expectFailure(runProgram("strata-convert", {"--plan", (folder / "empty.las").string()}));
  expectFailure(runProgram("strata-convert", {"--plan", (folder / "absent.las").string()}));
  expectUsageError(runProgram("strata-convert", {"--plan"}));
  expectUsageError(runProgram("strata-convert", {"synthetic:room?points=10"}));
}

TEST(Plan, WarnsOfADiskThatIsTooSmall) {
  const TempFolder folder;
  const Finished finished = runProgram("strata-convert", {"--plan", "synthetic:city?points=1e11"});
  EXPECT_EQ(finished.exitCode, 0) << finished.err;
  EXPECT_NE(finished.out.find("warning: .: the disk may be too small"), std::string::npos) << finished.out;
}

}  // namespace
}  // namespace strata::test
