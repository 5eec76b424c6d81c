#include "io/table/pcd_source.h"

#include <algorithm>
#include <fstream>

#include "core/error.h"
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

class PcdText : public testing::Test {
 protected:
  std::unique_ptr<PointSource> open(const std::string& bytes, const SourceOptions& options = {}) {
    std::ofstream(path(), std::ios::binary) << bytes;
    return openPcd(path(), options);
  }
  std::string path() const { return (folder_ / "scan.pcd").string(); }
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

TEST(PcdSource, ReadsEveryRealFileWithTheExpectedPoints) {
  STRATA_REQUIRE_DATA();
  const std::vector<ExpectedScan> scans = expectedScans("pcd/");
  ASSERT_GE(scans.size(), 15u);
  for (const ExpectedScan& scan : scans) expectScan(scan, *openPcd(dataFile(scan.file), {}));
}

TEST(PcdSource, AgreesWithPclOnEveryRealFile) {
  STRATA_REQUIRE_DATA();
  for (const ExpectedScan& scan : expectedScans("pcd/")) {
    SCOPED_TRACE(scan.file);
    const auto source = openPcd(dataFile(scan.file), {});
    const PointBlock points = readSource(*source);
    const auto pcl = readWithPcl(dataFile(scan.file));
    ASSERT_TRUE(pcl.has_value());
    ASSERT_EQ(pcl->points, points.count());
    for (std::size_t f = 0; f < pcl->fields.size(); ++f) {
      const std::string& name = pcl->fields[f];
      const std::size_t axis = std::string("xyzXYZ").find(name) % 3;
      const bool position = name.size() == 1 && std::string("xyzXYZ").find(name) != std::string::npos;
      const bool extra = source->info().layout.find("extra:" + name) >= 0;
      if (!position && !extra) continue;
      for (std::size_t i = 0; i < points.count(); ++i) {
        const double ours =
            position ? points.positions[i][static_cast<int>(axis)] : valueOf(*source, points, i, "extra:" + name);
        const double theirs = pcl->values[f][i];
        if (std::isnan(theirs))
          ASSERT_TRUE(std::isnan(ours)) << name << " " << i;
        else
          ASSERT_EQ(static_cast<float>(ours), static_cast<float>(theirs)) << name << " " << i;
      }
    }
  }
}

TEST(PcdSource, PackedColoursComeOutAsPclHasThem) {
  STRATA_REQUIRE_DATA();
  for (const char* name : {"pcd/milk_color.pcd", "pcd/colored_cloud.pcd"}) {
    SCOPED_TRACE(name);
    const auto source = openPcd(dataFile(name), {});
    const PointBlock points = readSource(*source);
    const auto pcl = readWithPcl(dataFile(name));
    ASSERT_TRUE(pcl.has_value());
    const auto field =
        std::find_if(pcl->fields.begin(), pcl->fields.end(), [](const std::string& f) { return f.starts_with("rgb"); });
    ASSERT_NE(field, pcl->fields.end());
    const std::vector<double>& packed = pcl->values[static_cast<std::size_t>(field - pcl->fields.begin())];
    for (std::size_t i = 0; i < points.count(); ++i) {
      const auto word = static_cast<std::uint32_t>(packed[i]);
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_EQ(valueOf(*source, points, i, "rgb", k), word >> (16 - 8 * k) & 255) << i;
    }
  }
}

TEST(PcdSource, CountsPointsThatAreNotFinite) {
  STRATA_REQUIRE_DATA();
  const auto notFinite = [](const char* name) {
    const PointBlock points = readSource(*openPcd(dataFile(name), {}));
    return std::count_if(points.positions.begin(), points.positions.end(), [](auto& p) { return !isFinite(p); });
  };
  EXPECT_EQ(notFinite("pcd/table_scene_mug_stereo_textured.pcd"), 97920);
  EXPECT_EQ(notFinite("pcd/office1.pcd"), 52744);
}

TEST(PcdSource, TwinsHaveTheSamePoints) {
  STRATA_REQUIRE_DATA();
  const auto ascii = openPcd(dataFile("pcd/pcd_ascii.pcd"), {});
  const PointBlock a = readSource(*ascii), b = readSource(*openPcd(dataFile("pcd/pcd_binary.pcd"), {}));
  ASSERT_EQ(a.count(), b.count());
  EXPECT_TRUE(ascii->info().gridExact);
  for (std::size_t i = 0; i < a.count(); ++i)  // the ascii twin was written with four decimals
    ASSERT_LE(glm::length(a.positions[i] - b.positions[i]), 1e-4) << i;
}

TEST(PcdSource, IntegerFieldsOfLasKeepTheirMeaning) {
  STRATA_REQUIRE_DATA();
  const auto source = openPcd(dataFile("pcd/autzen-utm.pcd"), {});
  for (const char* name : {"intensity", "classification", "return_number", "number_of_returns", "user_data",
                           "point_source_id", "gps_time", "rgb", "extra:ScanAngleRank"})
    EXPECT_GE(source->info().layout.find(name), 0) << name;
  EXPECT_TRUE(source->info().gridExact);
  EXPECT_EQ(source->info().step, glm::dvec3(0.01));
  const PointBlock points = readSource(*source);
  EXPECT_EQ(valueOf(*source, points, 0, "intensity"), 143.0);
  EXPECT_EQ(valueOf(*source, points, 0, "rgb", 0), 68.0);
}

TEST(PcdSource, RefusesAFileWithoutAHeader) {
  STRATA_REQUIRE_DATA();
  EXPECT_THROW(openPcd(dataFile("pcd/edge/missingheader.pcd"), {}), Error);
}

TEST(PcdSource, RefusesCompressedCloudsThatMemoryCannotHold) {
  STRATA_REQUIRE_DATA();
  SourceOptions options;
  options.memoryBytes = 4 << 20;
  try {
    openPcd(dataFile("pcd/office1.pcd"), options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("convert it to PCD binary"), std::string::npos) << error.what();
  }
}

constexpr const char* kHeader = "VERSION 0.7\nFIELDS x y z _ h\nSIZE 1 1 1 1 1\nTYPE U U U U U\nCOUNT 1 1 1 2 2\n";

TEST_F(PcdText, FieldsOfSeveralValuesAndPaddingAreUnderstood) {
  const std::string binary = std::string(kHeader) + "POINTS 1\nDATA binary\n\x01\x02\x03__\x04\x05";
  const std::string ascii = std::string(kHeader) + "POINTS 1\nDATA ascii\n1 2 3 nan nan 4 5\n";
  for (const std::string& text : {binary, ascii}) {
    const auto source = open(text);
    const PointBlock points = readSource(*source);
    ASSERT_EQ(points.count(), 1u);
    EXPECT_EQ(points.positions[0], glm::dvec3(1, 2, 3));
    EXPECT_EQ(valueOf(*source, points, 0, "extra:h", 1), 5.0);
    EXPECT_EQ(source->info().layout.stride(), 2u);
  }
}

TEST_F(PcdText, AsciiColoursMayBeIntegersOrFloats) {
  const std::string header = "FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 2\nHEIGHT 1\nDATA ascii\n";
  const auto source = open(header + "0 0 0 66051\n0 0 0 9.2557164867118492e-41\n");
  const PointBlock points = readSource(*source);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(valueOf(*source, points, i, "rgb", k), 1.0 + static_cast<double>(k));
}

TEST_F(PcdText, RefusesFilesThatEndEarly) {
  EXPECT_EQ(refusal(std::string(kHeader) + "POINTS 2\nDATA binary\n12345671234"),
            "the file ends early, found 1 points (expected 2)");
  EXPECT_EQ(refusal(std::string(kHeader) + "POINTS 2\nDATA ascii\n1 2 3 4 5 6 7\n"),
            "the file ends early, found 1 points (expected 2)");
  EXPECT_NE(refusal(std::string(kHeader) + "POINTS 1000000000000\nDATA binary_compressed\n12345678"), "");
}

TEST_F(PcdText, RefusesHeadersThatMakeNoSense) {
  const std::string three = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n";
  for (const std::string& text :
       {std::string("FIELDS x y z\nDATA ascii\n"), three + "POINTS -1\nDATA ascii\n",
        three + "COUNT 1 1\nPOINTS 1\nDATA ascii\n1 2 3\n", three + "COUNT 1 1 0\nPOINTS 1\nDATA ascii\n1 2 3\n",
        three + "COUNT 1 1 99999999999\nPOINTS 1\nDATA ascii\n1 2 3\n", three + "POINTS 1\nDATA zip\n1 2 3\n",
        three + "WIDTH 3\nHEIGHT 2\nPOINTS 5\nDATA ascii\n",
        three + "WIDTH 9223372036854775807\nHEIGHT 3\nDATA ascii\n",
        std::string("FIELDS x y z\nSIZE 3 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"),
        std::string("FIELDS x y w\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"), std::string("POINTS 1\n")})
    EXPECT_NE(refusal(text), "") << text;
}

TEST_F(PcdText, PrefixesAndDamagedBytesAreReadOrRefusedButNeverMore) {
  STRATA_REQUIRE_DATA();
  for (const char* name : {"pcd/nhood_test.pcd", "pcd/pcl_logo.pcd", "pcd/utm17_space.pcd"}) {
    const std::string whole = readFile(dataFile(name));
    const std::size_t stride = whole.size() > 5000 ? 97 : 1;
    for (std::size_t length = 0; length < whole.size(); length += length < 400 ? 1 : stride)
      refusal(whole.substr(0, length));
    for (std::size_t at = 0; at < whole.size(); at += stride) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
      refusal(damaged);
    }
  }
}

}  // namespace
}  // namespace strata
