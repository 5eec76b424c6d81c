// Real scans from Debian's package libcgal-demo, for machines without the larger set.
#include <cstdlib>

#include "tests/support/programs.h"
#include "tests/support/test_data.h"

namespace strata::test {
namespace {

constexpr const char* kArchives = "/usr/share/doc/libcgal-dev";

struct PackagedScan {
  const char* archive;
  const char* file;
  std::uint64_t points;
};

void PrintTo(const PackagedScan& scan, std::ostream* out) { *out << scan.file; }

class PackagedScans : public testing::TestWithParam<PackagedScan> {};

TEST_P(PackagedScans, ConvertToASoundStoreWithEveryPoint) {
  const PackagedScan scan = GetParam();
  const std::filesystem::path archive = std::filesystem::path(kArchives) / scan.archive;
  if (!std::filesystem::exists(archive)) GTEST_SKIP() << "the package libcgal-demo is not installed";
  const TempFolder folder;
  const std::string unpack = "tar xzf " + archive.string() + " -C " + folder.path().string() + " " + scan.file;
  ASSERT_EQ(std::system(unpack.c_str()), 0) << unpack;
  const std::filesystem::path store = folder / "scan.strata";
  const Json report = mustConvert({(folder / scan.file).string()}, store);
  EXPECT_EQ(report.at("points"), scan.points);
  const Json info = mustInfo(store, true);
  EXPECT_EQ(info.at("points"), scan.points);
  EXPECT_EQ(info.at("bad_nodes"), 0);
}

INSTANTIATE_TEST_SUITE_P(Cgal, PackagedScans,
                         testing::Values(PackagedScan{"examples.tar.gz",
                                                      "examples/Point_set_processing_3/data/urban.las", 13511},
                                         PackagedScan{"data.tar.gz", "data/points_3/building.ply", 100000},
                                         PackagedScan{"data.tar.gz", "data/points_3/b9_training.ply", 22300}),
                         [](const auto& scan) { return std::filesystem::path(scan.param.file).stem().string(); });

}  // namespace
}  // namespace strata::test
