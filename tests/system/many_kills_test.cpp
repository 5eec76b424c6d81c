// A conversion that is killed 200 times, at other moments each time.
#include "tests/support/interrupted.h"

namespace strata::test {
namespace {

TEST(ManyKills, ResumeToTheSameBytes) { expectKillsResume(200, kScan, {}); }

}  // namespace
}  // namespace strata::test
