// strata-view under random input for a minute, or for STRATA_SOAK_MINUTES.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/paths.h"
#include "tests/support/programs.h"

namespace strata::test {
namespace {

TEST(ViewerSoak, ItsMemoryDoesNotGrowWhileItIsMovedAtRandom) {
  for (const char* program : {"/usr/bin/xvfb-run", "/usr/bin/xdotool"})
    if (!std::filesystem::exists(program)) GTEST_SKIP() << program << " is not there";
  const TempFolder folder;
  const std::filesystem::path store = folder / "city.strata";
  mustConvert({"synthetic:city?points=3000000&seed=1"}, store);
  const char* minutes = std::getenv("STRATA_SOAK_MINUTES");
  const Finished soak = runProgram("/usr/bin/xvfb-run", {"-a", "-s", "-screen 0 1024x768x24 -noreset",
                                                         (sourceFolder() / "tests/system/viewer_soak.sh").string(),
                                                         programPath("strata-view").string(), store.string(),
                                                         (folder / "").string(), minutes != nullptr ? minutes : "1"});
  EXPECT_EQ(soak.exitCode, 0) << soak.out << soak.err;
  std::printf("%s", soak.out.c_str());
}

}  // namespace
}  // namespace strata::test
