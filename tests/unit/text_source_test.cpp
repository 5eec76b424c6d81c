#include "io/table/text_source.h"

#include <algorithm>
#include <fstream>

#include "core/error.h"
#include "io/table/text_format.h"
#include "tests/support/scan_points.h"

namespace strata {
namespace {

using namespace test;

std::string dataFile(const std::string& name) { return (dataFolder() / name).string(); }

class Text : public testing::Test {
 protected:
  std::unique_ptr<PointSource> open(const std::string& bytes, const SourceOptions& options = {}) {
    std::ofstream(path(), std::ios::binary) << bytes;
    return openText(path(), options);
  }
  std::string path() const { return (folder_ / "scan.xyz").string(); }
  std::string refusal(const std::string& bytes, const SourceOptions& options = {}) {
    try {
      readSource(*open(bytes, options));
    } catch (const Error& error) {
      const std::string line = error.what();
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      return line.starts_with(path() + ": ") ? line.substr(path().size() + 2) : line;
    }
    return "";
  }
  static SourceOptions columns(const std::string& names) {
    SourceOptions options;
    options.columns = names;
    return options;
  }

 private:
  TempFolder folder_;
};

TEST(TextSource, ReadsEveryRealFileWithTheExpectedPoints) {
  STRATA_REQUIRE_DATA();
  const std::vector<ExpectedScan> scans = expectedScans("text/");
  ASSERT_GE(scans.size(), 12u);
  for (const ExpectedScan& scan : scans) {
    const auto source = openText(dataFile(scan.file), {});
    expectScan(scan, *source);
    EXPECT_TRUE(source->info().boundsExact);
  }
}

TEST(TextSource, TwinsHaveTheSamePoints) {
  STRATA_REQUIRE_DATA();
  const PointBlock xyz = readSource(*openText(dataFile("text/bunny.xyz"), {}));
  EXPECT_TRUE(sameBits(xyz, readSource(*openText(dataFile("text/bunny.pts"), {}))));
}

TEST(TextSource, CoordinatesKeepTheGridOfTheirDecimals) {
  STRATA_REQUIRE_DATA();
  const auto utm = openText(dataFile("text/utm17_1.txt"), {});
  EXPECT_TRUE(utm->info().gridExact);
  EXPECT_EQ(utm->info().step, glm::dvec3(0.01));
  const auto agisoft = openText(dataFile("text/points_agisoft.xyz"), {});
  EXPECT_EQ(agisoft->info().step, glm::dvec3(0.000001));
  const auto scan = openText(dataFile("text/scan001.3d"), {});
  EXPECT_FALSE(scan->info().gridExact) << "it has numbers like 2.84217e-14";
  EXPECT_GT(scan->info().step.x, 0.0);
}

TEST(TextSource, NegativeIntensitiesOfPtsAreKeptAndDrawnIn16Bits) {
  STRATA_REQUIRE_DATA();
  const auto source = openText(dataFile("text/autzen.pts"), {});
  const PointBlock points = readSource(*source);
  EXPECT_EQ(valueOf(*source, points, 0, "extra:intensity"), -1613.0);
  EXPECT_EQ(valueOf(*source, points, 0, "intensity"), (-1613.0 + 2048.0) * 16.0);
  EXPECT_EQ(valueOf(*source, points, 0, "rgb", 0), 52.0);
  const auto bunny = openText(dataFile("text/bunny_2.pts"), {});
  const PointBlock b = readSource(*bunny);
  EXPECT_EQ(valueOf(*bunny, b, 0, "intensity"), 255.0);
  EXPECT_EQ(bunny->info().layout.find("extra:intensity"), -1);
}

TEST_F(Text, NamesInTheFirstLineDecide) {
  for (const char* header :
       {"//X Y Z Intensity GpsTime", "# x, y, z, i, gps_time", "\"X [m]\";\"Y [m]\";\"Z [m]\";I;GPSTime"}) {
    const auto source = open(std::string(header) + "\n# a comment\n1.5 2 3 7 123456.789012345\n");
    const PointBlock points = readSource(*source);
    ASSERT_EQ(points.count(), 1u) << header;
    EXPECT_EQ(points.positions[0], glm::dvec3(1.5, 2, 3));
    EXPECT_EQ(valueOf(*source, points, 0, "intensity"), 7.0) << header;
    EXPECT_EQ(valueOf(*source, points, 0, "gps_time"), 123456.789012345) << header;
  }
}

TEST_F(Text, TheNumberOfColumnsDecidesWhereNothingElseDoes) {
  const auto layoutOf = [&](const std::string& text) {
    std::string names;
    const auto source = open(text);
    for (const Attribute& a : source->info().layout.attributes()) names += a.name + " ";
    return names;
  };
  EXPECT_EQ(layoutOf("1 2 3\n"), "");
  EXPECT_EQ(layoutOf("1,2,3,4\n"), "intensity ");
  EXPECT_EQ(layoutOf("1;2;3;4;5\n"), "extra:column4 extra:column5 ");
  EXPECT_EQ(layoutOf("1\t2\t3\t255\t0\t9\n"), "rgb ");
  EXPECT_EQ(layoutOf("1 2 3 0.6 -0.8 0\n"), "normal ");
  EXPECT_EQ(layoutOf("1 2 3 4 5 6 7\n"), "rgb intensity ");
}

TEST_F(Text, TheUserMayNameTheColumns) {
  const auto source = open("9 1 2 3 4\n9 5 6 7 8\n", columns("-,y,x,z,extra:quality"));
  const PointBlock points = readSource(*source);
  EXPECT_EQ(points.positions[1], glm::dvec3(6, 5, 7));
  EXPECT_EQ(valueOf(*source, points, 1, "extra:quality"), 8.0);
  EXPECT_THROW(open("1 2 3\n", columns("x,y,height")), UsageError);
  EXPECT_THROW(open("1 2 3\n", columns("x,y")), UsageError);
  EXPECT_THROW(open("1 2 3\n", columns("x,y,z,x")), UsageError);
  EXPECT_EQ(readSource(*open("name a b c\nfoo 1 2 3\n", columns("-,x,y,z"))).positions.at(0), glm::dvec3(1, 2, 3));
}

TEST_F(Text, UnitColoursFillEightBits) {
  const auto source = open("1 2 3 0.5 0 1\n");
  const PointBlock points = readSource(*source);
  EXPECT_EQ(valueOf(*source, points, 0, "rgb", 0), 128.0);
  EXPECT_EQ(valueOf(*source, points, 0, "rgb", 2), 255.0);
}

TEST_F(Text, NumbersThatFloatsCannotHoldAreKeptAsDoubles) {
  const auto source = open("x y z time id big\n1 2 3 0.123456789 7 12345678901\n1 2 3 0.5 -8 1\n");
  const PointLayout& layout = source->info().layout;
  EXPECT_EQ(layout.attributes().at(0).type, ScalarType::f64);
  EXPECT_EQ(layout.attributes().at(1).type, ScalarType::i32);
  EXPECT_EQ(layout.attributes().at(2).type, ScalarType::i64);
}

TEST_F(Text, SeveralScansInOnePtsFileAreRead) {
  EXPECT_EQ(readSource(*open("2\r\n1 2 3\r\n4 5 6\r\n1\r\n7 8 9\r\n")).count(), 3u);
  EXPECT_EQ(refusal("3\n1 2 3\n4 5 6\n"), "the file ends early, found 2 points (expected 3)");
  EXPECT_EQ(refusal("1\n1 2 3\n4 5 6\n1\n7 8 9\n"),
            "line 1: it counts the points that follow, found 2 points (expected 1)");
}

TEST_F(Text, RefusesBadLinesByNumber) {
  EXPECT_EQ(refusal("1 2 3\n\n4 5\n"), "line 3: found 2 columns (expected 3)");
  EXPECT_EQ(refusal("# c\n1 2 3\n4 x 6\n"), "line 3: column 2: found 'x' (expected a number)");
  EXPECT_EQ(refusal("1,2,3\n4,,6\n"), "line 2: column 2: found '' (expected a number)");
  EXPECT_NE(refusal("1,5;2,5;3,5\n"), "");
  EXPECT_NE(refusal("1 2\n"), "");
  EXPECT_NE(refusal("# nothing\n"), "");
  EXPECT_NE(refusal("name east\n1 2 3\n"), "");
  SourceOptions options;
  options.skipDamaged = true;
  const auto source = open("1 2 3\n4 5\n7 8 9\n", options);
  EXPECT_EQ(source->info().pointCount, 3u);
  EXPECT_EQ(readSource(*source).count(), 2u);
}

TEST_F(Text, TheLastLineNeedsNoEnd) { EXPECT_EQ(readSource(*open("1 2 3\n4 5 6")).count(), 2u); }

TEST_F(Text, NotANumberIsDeliveredAsSuch) {
  const auto source = open("1 2 3\nnan nan nan\n+4 5e0 -inf\n");
  const PointBlock points = readSource(*source);
  ASSERT_EQ(points.count(), 3u);
  EXPECT_TRUE(std::isnan(points.positions[1].x));
  EXPECT_EQ(points.positions[2].x, 4.0);
  EXPECT_EQ(source->info().bounds.max, glm::dvec3(1, 2, 3));
  EXPECT_TRUE(source->info().gridExact);
}

TEST_F(Text, BinaryRubbishIsRefused) {
  std::string rubbish = "1 2 3\n";
  for (std::uint32_t i = 0, x = 1; i < 3'000'000; ++i, x = x * 1664525 + 1013904223)
    rubbish += static_cast<char>(x >> 24);
  EXPECT_NE(refusal(rubbish), "");
  EXPECT_NE(refusal("1 2 3\n" + std::string(3 << 20, '7')), "");
}

TEST_F(Text, PrefixesAreReadOrRefusedButNeverMore) {
  const std::string whole =
      "\xEF\xBB\xBF// x;y;z;\"r\";g;b\r\n3\n1;2;3;4;5;6\r\n-1.5e-3, 2 3\t4 5 6 extra\n\n2 2 2 2 2 2\n1\n";
  for (std::size_t length = 0; length <= whole.size(); ++length) refusal(whole.substr(0, length));
}

TEST_F(Text, PartsOfLargeFilesReadInParallelGiveTheSamePoints) {
  std::string text;
  constexpr int kPoints = 4'000'000;
  text.reserve(std::size_t{90} << 20);
  for (int i = 0; i < kPoints; ++i) {
    text += std::to_string(i) + ".25 " + std::to_string(i % 1000) + " 12.5\r\n";
    if (i == 1'234'567) text += "# between\n\n";
  }
  const auto source = open(text);
  EXPECT_GE(source->partCount(), 2u);
  EXPECT_EQ(source->info().pointCount, static_cast<std::uint64_t>(kPoints));
  EXPECT_EQ(source->info().bounds.max, glm::dvec3(kPoints - 0.75, 999, 12.5));
  const PointBlock points = readSource(*source, 65536);
  ASSERT_EQ(points.count(), static_cast<std::size_t>(kPoints));
  for (int i = 0; i < kPoints; ++i)
    ASSERT_EQ(points.positions[static_cast<std::size_t>(i)], glm::dvec3(i + 0.25, i % 1000, 12.5));
  EXPECT_TRUE(sameBits(points, readInParallel(*source)));
  text += "1 2\n";
  EXPECT_EQ(refusal(text), "line " + std::to_string(kPoints + 3) + ": found 2 columns (expected 3)");
}

}  // namespace
}  // namespace strata
