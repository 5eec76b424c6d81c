// The kill test at length.
#include "tests/support/interrupted.h"

namespace strata::test {
namespace {

TEST(ManyKills, ResumeToTheSameBytes) { expectKillsResume(200, kScan, {}); }

}  // namespace
}  // namespace strata::test
