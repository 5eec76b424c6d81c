// The longest round trips: a file of four million points, and the 119 tiles that it was made from one by one.
#include "tests/support/las_decoder.h"
#include "tests/support/real_scans.h"

namespace strata::test {
namespace {

class LargeScan : public testing::TestWithParam<RealScan> {};

TEST_P(LargeScan, ComesBackBitForBit) {
  STRATA_REQUIRE_DATA();
  expectRecordsComeBack(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Real, LargeScan, testing::ValuesIn(scansWhere([](const RealScan& scan) {
                           return scan.isLas() && (scan.isTile() || scan.points >= 1000000);
                         })),
                         testName);

}  // namespace
}  // namespace strata::test
