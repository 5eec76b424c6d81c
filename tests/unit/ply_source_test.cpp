#include "io/table/ply_source.h"

#include <algorithm>
#include <fstream>

#include "core/error.h"
#include "io/table/ply_header.h"
#include "tests/support/pcl_oracle.h"
#include "tests/support/scan_points.h"

namespace strata {
namespace {

using namespace test;

std::string dataFile(const std::string& name) { return (dataFolder() / name).string(); }

std::string readFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Writes `bytes` as a PLY file and opens it.
class PlyText : public testing::Test {
 protected:
  std::unique_ptr<PointSource> open(const std::string& bytes, const SourceOptions& options = {}) {
    std::ofstream(path(), std::ios::binary) << bytes;
    return openPly(path(), options);
  }
  std::string path() const { return (folder_ / "scan.ply").string(); }
  std::string refusal(const std::string& bytes) {
    try {
      readSource(*open(bytes));
    } catch (const Error& error) {
      const std::string line = error.what();
      EXPECT_TRUE(line.starts_with(path() + ": ")) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      return line.substr(path().size() + 2);
    }
    return "";
  }

 private:
  TempFolder folder_;
};

TEST(PlySource, ReadsEveryRealFileWithTheExpectedPoints) {
  STRATA_REQUIRE_DATA();
  const std::vector<ExpectedScan> scans = expectedScans("ply/");
  ASSERT_GE(scans.size(), 18u);
  for (const ExpectedScan& scan : scans) expectScan(scan, *openPly(dataFile(scan.file), {}));
}

TEST(PlySource, AgreesWithPclWherePclReadsTheFileRight) {
  STRATA_REQUIRE_DATA();
  for (const char* name : {"ply/bunny.ply", "ply/target.ply", "ply/cloud_bin_0.ply", "ply/horse.ply",
                           "ply/ripple_bin.ply", "ply/ripple_ascii.ply", "ply/building.ply", "ply/bun_zipper.ply"}) {
    SCOPED_TRACE(name);
    const auto source = openPly(dataFile(name), {});
    const PointBlock points = readSource(*source);
    const auto pcl = readWithPcl(dataFile(name));
    ASSERT_TRUE(pcl.has_value());
    ASSERT_EQ(pcl->points, points.count());
    for (int axis = 0; axis < 3; ++axis) {
      const auto field = std::find(pcl->fields.begin(), pcl->fields.end(), std::string(1, "xyz"[axis]));
      ASSERT_NE(field, pcl->fields.end());
      const std::vector<double>& values = pcl->values[static_cast<std::size_t>(field - pcl->fields.begin())];
      for (std::size_t i = 0; i < points.count(); ++i)
        ASSERT_EQ(static_cast<float>(points.positions[i][axis]), static_cast<float>(values[i])) << i;
    }
  }
}

TEST(PlySource, AsciiAndBinaryTwinsHaveTheSamePoints) {
  STRATA_REQUIRE_DATA();
  const auto ascii = openPly(dataFile("ply/ripple_ascii.ply"), {});
  const auto binary = openPly(dataFile("ply/ripple_bin.ply"), {});
  const PointBlock a = readSource(*ascii), b = readSource(*binary);
  ASSERT_EQ(a.count(), b.count());
  EXPECT_TRUE(ascii->info().gridExact);
  for (std::size_t i = 0; i < a.count(); ++i) {
    EXPECT_LE(glm::length(a.positions[i] - b.positions[i]), 1e-5);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(valueOf(*ascii, a, i, "rgb", k), valueOf(*binary, b, i, "rgb", k));
      EXPECT_NEAR(valueOf(*ascii, a, i, "normal", k), valueOf(*binary, b, i, "normal", k), 1e-5);
    }
  }
}

TEST(PlySource, KeepsDoublesAndLargeIntegers) {
  STRATA_REQUIRE_DATA();
  const auto source = openPly(dataFile("ply/edge/issue_2421.ply"), {});
  const PointBlock points = readSource(*source);
  EXPECT_EQ(points.positions[0], glm::dvec3(1.23457, 12345.6789, 1234567890.12345));
  EXPECT_EQ(valueOf(*source, points, 0, "extra:i"), 1234567890.0);
}

TEST(PlySource, DeliversPointsThatAreNotFinite) {
  STRATA_REQUIRE_DATA();
  const PointBlock points = readSource(*openPly(dataFile("ply/edge/float_inf_point_cloud.ply"), {}));
  EXPECT_EQ(std::count_if(points.positions.begin(), points.positions.end(), [](auto& p) { return !isFinite(p); }), 3);
}

TEST(PlySource, AnEmptyCloudIsASourceOfNoPoints) {
  STRATA_REQUIRE_DATA();
  const auto source = openPly(dataFile("ply/edge/empty.ply"), {});
  EXPECT_EQ(source->info().pointCount, 0u);
  EXPECT_EQ(readSource(*source).count(), 0u);
}

TEST(PlySource, RefusesRealFilesWithoutPoints) {
  STRATA_REQUIRE_DATA();
  for (const char* name : {"ply/edge/no_vertex.ply", "ply/edge/sized_dims.ply", "ply/edge/unsized_dims.ply"})
    EXPECT_THROW(openPly(dataFile(name), {}), Error) << name;
}

TEST(PlySource, KeepsSplatPropertiesUnderTheirNames) {
  STRATA_REQUIRE_DATA();
  const auto source = openPly(dataFile("ply/train-1000.ply"), {});
  EXPECT_GE(source->info().layout.find("extra:f_dc_0"), 0);
  EXPECT_GE(source->info().layout.find("extra:rot_3"), 0);
  EXPECT_EQ(source->info().layout.find("rgb"), -1);
}

TEST_F(PlyText, FloatIntensityIsKeptExactlyAndDrawnIn16Bits) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property float scalar_Intensity\nend_header\n";
  const auto source = open(header + "0 0 0 0.5\n1 1 1 0.125\n");
  const PointBlock points = readSource(*source);
  EXPECT_EQ(valueOf(*source, points, 1, "extra:intensity"), 0.125);
  EXPECT_EQ(valueOf(*source, points, 1, "intensity"), std::round(0.125 * 65535));
}

TEST_F(PlyText, AsciiListsAmongTheVerticesAndElementsBeforeThemArePassedOver) {
  const auto source = open(
      "ply\nformat ascii 1.0\nelement camera 1\nproperty list uchar int ids\nproperty float f\nelement vertex 2\n"
      "property float x\nproperty list uchar float weights\nproperty float y\nproperty float z\nend_header\n"
      "2 7 8 1.5\n\n1 3 9 9 9 2 3\n4 0 5 6\n");
  const PointBlock points = readSource(*source);
  ASSERT_EQ(points.count(), 2u);
  EXPECT_EQ(points.positions[0], glm::dvec3(1, 2, 3));
  EXPECT_EQ(points.positions[1], glm::dvec3(4, 5, 6));
}

TEST_F(PlyText, BinaryListsBeforeTheVerticesArePassedOver) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement face 2\nproperty list uchar short ids\nelement vertex 1\n"
      "property uchar x\nproperty uchar y\nproperty uchar z\nend_header\n";
  bytes += std::string("\x02\x01\x00\x02\x00", 5) + std::string("\x00", 1) + "\x07\x08\x09";
  const PointBlock points = readSource(*open(bytes));
  ASSERT_EQ(points.count(), 1u);
  EXPECT_EQ(points.positions[0], glm::dvec3(7, 8, 9));
}

TEST_F(PlyText, ALineEndInTheHeaderMayBeCrLf) {
  std::string bytes =
      "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 1\r\nproperty uchar x\r\nproperty uchar y\r\n"
      "property uchar z\r\nend_header\r\n\x01\x02\x03";
  EXPECT_EQ(readSource(*open(bytes)).positions.at(0), glm::dvec3(1, 2, 3));
}

TEST_F(PlyText, RefusesFilesThatEndEarly) {
  const std::string properties = "property uchar x\nproperty uchar y\nproperty uchar z\nend_header\n";
  EXPECT_EQ(refusal("ply\nformat binary_little_endian 1.0\nelement vertex 3\n" + properties + "1234567"),
            "the file ends early, found 2 points (expected 3)");
  EXPECT_EQ(refusal("ply\nformat ascii 1.0\nelement vertex 3\n" + properties + "1 2 3\n4 5 6\n"),
            "the file ends early, found 2 points (expected 3)");
  EXPECT_EQ(refusal("ply\nformat binary_big_endian 1.0\nelement vertex 18446744073709551615\n" + properties + "123"),
            "the file ends early, found 1 points (expected 18446744073709551615)");
}

TEST_F(PlyText, RefusesBadLinesByNumber) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty uchar z\nend_header\n";
  EXPECT_EQ(refusal(header + "1 2 3\n4 5\n"), "line 9: found 2 columns (expected 3)");
  EXPECT_EQ(refusal(header + "1 2 3\n4 five 6\n"), "line 9: column 2: found 'five' (expected a number)");
  EXPECT_EQ(refusal(header + "1 2 3\n4 5 256\n"), "line 9: column 3: found '256' (expected a value of type u8)");
  SourceOptions options;
  options.skipDamaged = true;
  const auto source = open(header + "1 2 3\n4 five 6\n", options);
  EXPECT_EQ(source->info().pointCount, 2u);
  EXPECT_EQ(readSource(*source).count(), 1u);
}

TEST_F(PlyText, SkipsWhatIsMissingWhereDamageIsAccepted) {
  SourceOptions options;
  options.skipDamaged = true;
  const auto source = open(
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\n"
      "property uchar z\nend_header\n1234567",
      options);
  EXPECT_EQ(source->info().pointCount, 3u);
  EXPECT_EQ(readSource(*source).count(), 2u);
}

TEST_F(PlyText, RefusesHeadersThatMakeNoSense) {
  for (const char* text :
       {"plx\n", "ply\n", "ply\nelement vertex 1\nproperty float x\nend_header\n",
        "ply\nformat ascii 2.0\nend_header\n", "ply\nformat text 1.0\nend_header\n",
        "ply\nformat ascii 1.0\nelement vertex -1\nend_header\n",
        "ply\nformat ascii 1.0\nproperty float x\nend_header\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\nend_header\n",
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list uchar float w\nproperty float x\n"
        "property float y\nproperty float z\nend_header\n",
        "ply\nformat binary_little_endian 1.0\nelement vertex 5\nend_header\n", "ply\nformat ascii 1.0\nnonsense\n"})
    EXPECT_NE(refusal(text), "") << text;
}

TEST_F(PlyText, PrefixesAreReadOrRefusedButNeverMore) {
  STRATA_REQUIRE_DATA();
  for (const char* name : {"ply/edge/diamond_with_bool.ply", "ply/edge/points_ascii_with_lists.ply",
                           "ply/edge/test_extra_whitespace.ply", "ply/edge/simple_binary.ply"}) {
    const std::string whole = readFile(dataFile(name));
    for (std::size_t length = 0; length < whole.size(); ++length) refusal(whole.substr(0, length));
  }
}

TEST_F(PlyText, PartsOfLargeFilesReadInParallelGiveTheSamePoints) {
  constexpr std::uint32_t kPoints = 2'500'000;
  std::string bytes = "ply\nformat binary_big_endian 1.0\nelement vertex " + std::to_string(kPoints) +
                      "\nproperty ushort x\nproperty uchar y\nproperty uchar z\nend_header\n";
  for (std::uint32_t i = 0; i < kPoints; ++i)
    for (int shift : {24, 16, 8, 0}) bytes += static_cast<char>(i >> shift & 255);
  const auto source = open(bytes);
  EXPECT_EQ(source->partCount(), 3u);
  const PointBlock points = readSource(*source, 65536);
  ASSERT_EQ(points.count(), kPoints);
  for (std::uint32_t i = 0; i < kPoints; ++i)
    ASSERT_EQ(points.positions[i], glm::dvec3(i >> 16, i >> 8 & 255, i & 255));
  EXPECT_TRUE(sameBits(points, readInParallel(*source)));
}

}  // namespace
}  // namespace strata
