#include "viewer/bench/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "core/error.h"
#include "core/percentile.h"
#include "core/readable.h"
#include "io/file/text_file.h"
#include "tests/support/test_data.h"
#include "viewer/bench/compare.h"
#include "viewer/bench/html_plot.h"
#include "viewer/output/html_text.h"

namespace strata {
namespace {

std::vector<FrameRecord> someFrames(int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> ms(5.0, 40.0);
  std::vector<FrameRecord> frames;
  for (int i = 0; i < count; ++i) {
    FrameRecord frame;
    frame.index = i;
    frame.t = i / 30.0;
    frame.frameMs = ms(random);
    frame.pointsDrawn = 1000000u + static_cast<std::uint64_t>(i) * 1000u;
    frame.pointsListed = frame.pointsDrawn + 5000u;
    frame.bytesRead = static_cast<std::uint64_t>(i) * 100000u;
    frames.push_back(frame);
  }
  return frames;
}

BenchReport someReport() {
  BenchReport report;
  report.program = "strata-bench test";
  report.when = "2020-01-02T03:04:05Z";
  report.storePath = "/data/<b>city</b> & \"park\".strata";
  report.storeName = "<b>city</b> & \"park\"";
  report.store = {{"points", "12 M"}, {"sources", "a<script src=x>.laz"}};
  report.options = {{"size", "1920x1080"}};
  report.frames = someFrames(300);
  report.measures = measureFrames(report.frames);
  report.measures.backend = "cpu";
  report.measures.device = "2 threads";
  report.stages = {{"draw", 8.0, 9.0, true}, {"LOD pass", 1.0, 2.0, false}};
  report.counters = {{"nodes loaded", 12.0}};
  Image picture{1600, 900, std::vector<std::uint32_t>(1600u * 900u, 0xff102030u)};
  report.pictures = {{"overview", "overview.png", false, picture}, {"frame 30", "frame_00030.png", true, picture}};
  return report;
}

TEST(Measures, PercentilesLieBetweenTheRanks) {
  const std::vector<double> values{40.0, 10.0, 30.0, 20.0};
  EXPECT_EQ(percentile(values, 0.0), 10.0);
  EXPECT_EQ(percentile(values, 50.0), 25.0);
  EXPECT_EQ(percentile(values, 100.0), 40.0);
  EXPECT_NEAR(percentile(values, 95.0), 38.5, 1e-12);
  EXPECT_EQ(percentile(std::vector<double>{7.0}, 99.0), 7.0);
  EXPECT_EQ(percentile({}, 50.0), 0.0);
}

TEST(Measures, PercentilesGrowAndStayInsideTheValues) {
  std::mt19937 random(3);
  std::lognormal_distribution<double> ms(2.0, 1.0);
  for (int round = 0; round < 20; ++round) {
    std::vector<double> values(static_cast<std::size_t>(1 + round * 7));
    std::generate(values.begin(), values.end(), [&] { return ms(random); });
    double before = *std::min_element(values.begin(), values.end());
    for (double p = 0.0; p <= 100.0; p += 0.5) {
      const double value = percentile(values, p);
      EXPECT_GE(value, before);
      before = value;
    }
    EXPECT_EQ(before, *std::max_element(values.begin(), values.end()));
  }
}

TEST(Measures, AHitchIsLongAndLongerThanTheFrameBefore) {
  EXPECT_TRUE(isHitch(30.0, 61.0));
  EXPECT_FALSE(isHitch(30.0, 59.0));
  EXPECT_FALSE(isHitch(50.0, 70.0));
  EXPECT_FALSE(isHitch(100.0, 101.0));
}

TEST(Measures, PointsPerSecondAreAllPointsOverAllFrameTime) {
  std::vector<FrameRecord> frames(2);
  frames[0].frameMs = 10.0;
  frames[0].pointsDrawn = 100;
  frames[1].frameMs = 30.0;
  frames[1].pointsDrawn = 300;
  const BenchMeasures measures = measureFrames(frames);
  EXPECT_NEAR(measures.pointsPerSecond, 10000.0, 1e-9);
  EXPECT_EQ(measures.pointsDrawnMean, 200.0);
  EXPECT_EQ(measures.frames, 2);
}

TEST(Measures, JsonHasEveryNameOfTheContract) {
  const nlohmann::json json = nlohmann::json::parse(measuresJson(measureFrames(someFrames(10))));
  for (const char* name : {"frames", "frame_ms", "points_per_second", "points_drawn_mean", "time_to_full_detail_ms",
                           "lod_ms", "bytes_read", "cache_hit_rate", "hitches", "backend", "device"})
    EXPECT_TRUE(json.contains(name)) << name;
  for (const char* name : {"p50", "p95", "p99", "max"}) EXPECT_TRUE(json["frame_ms"].contains(name)) << name;
  EXPECT_EQ(measuresJson(measureFrames({})).find('\n'), std::string::npos);
}

TEST(Report, HasNoExternalReferenceAndNoScript) {
  std::string html = reportHtml(someReport());
  for (const char* forbidden : {"http:", "https:", "//", "<script", "<link", "@import", "url(", "<iframe", "srcset"}) {
    std::size_t at = html.find(forbidden);
    // Base64 may hold "//" by chance; only what stands outside of a data address counts.
    while (at != std::string::npos && html.rfind("data:image/png;base64,", at) != std::string::npos &&
           html.find('"', html.rfind("data:image/png;base64,", at)) > at)
      at = html.find(forbidden, at + 1);
    EXPECT_EQ(at, std::string::npos) << forbidden;
  }
  std::size_t pictures = 0;
  for (std::size_t at = html.find("src="); at != std::string::npos; at = html.find("src=", at + 1)) {
    if (html.compare(at, 6, "src=x&") == 0) continue;  // the escaped name of a source
    EXPECT_EQ(html.compare(at, 27, "src=\"data:image/png;base64,"), 0);
    ++pictures;
  }
  EXPECT_EQ(pictures, 2u);
}

TEST(Report, EscapesWhatComesFromFiles) {
  const std::string html = reportHtml(someReport());
  EXPECT_EQ(html.find("<b>city"), std::string::npos);
  EXPECT_NE(html.find("&lt;b&gt;city&lt;/b&gt; &amp; &quot;park&quot;"), std::string::npos);
}

TEST(Report, SurvivesARunOfPicturesOnlyAndOfOneFrame) {
  BenchReport report = someReport();
  report.frames = someFrames(1);
  report.measures = measureFrames(report.frames);
  EXPECT_EQ(reportHtml(report).find("nan"), std::string::npos);
  report.frames.clear();
  report.measures = measureFrames({});
  EXPECT_EQ(reportHtml(report).find("Along the path"), std::string::npos);
}

TEST(Report, JsonHoldsTheMeasuresAndSurvivesBadText) {
  BenchReport report = someReport();
  report.store.emplace_back("crs", "\xff\xfe broken");
  const nlohmann::json json = nlohmann::json::parse(reportJson(report));
  EXPECT_EQ(json["measures"]["frames"], 300);
  EXPECT_EQ(json["store"]["points"], "12 M");
}

TEST(Report, CsvHasALineForEachFrame) {
  const std::string csv = framesCsv(someFrames(12));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 13);
  const std::string header = csv.substr(0, csv.find('\n'));
  const std::string last = csv.substr(csv.rfind('\n', csv.size() - 2) + 1);
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(last.begin(), last.end(), ','));
}

TEST(Report, WritesItsThreeFiles) {
  const test::TempFolder folder;
  writeReport(folder.path().string(), someReport());
  for (const char* name : {"report.json", "frames.csv", "report.html"})
    EXPECT_GT(std::filesystem::file_size(folder / name), 0u) << name;
}

TEST(TextFile, AFullDiskIsAnErrorThatNamesTheFile) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  try {
    writeText("/dev/full", std::string(100000, 'x'));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()), "/dev/full: writing: No space left on device");
  }
}

TEST(TextFile, AFolderThatIsAFileIsAnError) {
  const test::TempFolder folder;
  writeText((folder / "plain").string(), "x");
  EXPECT_THROW(makeFolder((folder / "plain/below").string()), Error);
  EXPECT_THROW(readText(folder.path().string()), Error);
}

TEST(Base64, AgreesWithTheVectorsOfRfc4648) {
  const auto encode = [](const std::string& text) {
    return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encode("\xff\xfe\xfd"), "//79");
}

TEST(Readable, NumbersHaveThreeDigits) {
  EXPECT_EQ(readableCount(0), "0");
  EXPECT_EQ(readableCount(950), "950");
  EXPECT_EQ(readableCount(12345), "12.3 k");
  EXPECT_EQ(readableCount(999700), "1.00 M");
  EXPECT_EQ(readableBytes(1.5e9), "1.50 GB");
  EXPECT_EQ(readableMs(8.306), "8.31 ms");
  EXPECT_EQ(readableMs(2400), "2.40 s");
}

TEST(Plot, TheAxisEndsAtARoundNumberAboveTheHighest) {
  EXPECT_EQ(niceCeiling(0.0), 1.0);
  EXPECT_EQ(niceCeiling(33.0), 50.0);
  EXPECT_EQ(niceCeiling(100.0), 100.0);
  EXPECT_EQ(niceCeiling(0.021), 0.025);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> exponent(-6.0, 12.0);
  for (int i = 0; i < 1000; ++i) {
    const double value = std::pow(10.0, exponent(random));
    EXPECT_GE(niceCeiling(value) * (1.0 + 1e-9), value);
    EXPECT_LE(niceCeiling(value), value * 2.5);
  }
}

TEST(Plot, KeepsAPeakOfOneFrameInALongRun) {
  Plot plot{"t", "", {}, {{"a", "a", {}, false}}, {}, readableMs};
  for (int i = 0; i < 50000; ++i) {
    plot.x.push_back(i);
    plot.lines[0].values.push_back(i == 31415 ? 100.0 : 1.0);
  }
  const std::string html = plotHtml(plot);
  EXPECT_NE(html.find(",0.0 "), std::string::npos);
  EXPECT_LT(html.size(), 60000u);
}

TEST(Compare, CallsASlowerRunWorseAndAFasterOneNot) {
  BenchReport a = someReport();
  BenchReport b = someReport();
  b.measures.p50Ms *= 1.2;
  const Comparison slower = compareReports("A", reportJson(a), "B", reportJson(b));
  EXPECT_TRUE(anyWorse(slower, 0.05));
  EXPECT_FALSE(anyWorse(slower, 0.25));
  EXPECT_FALSE(anyWorse(compareReports("B", reportJson(b), "A", reportJson(a)), 0.05));
  EXPECT_FALSE(anyWorse(compareReports("A", reportJson(a), "A", reportJson(a)), 0.0));
  EXPECT_NE(comparisonTable(slower, 0.05).find("worse"), std::string::npos);
}

TEST(Compare, CountsFewerPointsASecondAsWorseAndNewHitchesToo) {
  BenchReport a = someReport();
  BenchReport b = someReport();
  b.measures.pointsPerSecond *= 0.8;
  EXPECT_TRUE(anyWorse(compareReports("A", reportJson(a), "B", reportJson(b)), 0.2));
  b = someReport();
  a.measures.hitches = 0;
  b.measures.hitches = 1;
  EXPECT_TRUE(anyWorse(compareReports("A", reportJson(a), "B", reportJson(b)), 1e9));
  EXPECT_FALSE(
      anyWorse(compareReports("A", reportJson(a), "B", reportJson(b)), std::numeric_limits<double>::infinity()));
}

TEST(Compare, SaysInWhatTheRunsDiffer) {
  BenchReport a = someReport();
  BenchReport b = someReport();
  b.measures.backend = "points";
  b.options = {{"size", "640x480"}};
  a.commit = "one";
  b.commit = "two";
  a.storeHash = "aa";
  b.storeHash = "bb";
  const Comparison comparison = compareReports("A", reportJson(a), "B", reportJson(b));
  EXPECT_EQ(comparison.differences, (std::vector<std::string>{"commit: one / two", "backend: cpu / points",
                                                              "store's hash: aa / bb", "size: 1920x1080 / 640x480"}));
}

TEST(Compare, RefusesWhatIsNoReport) {
  const std::string good = reportJson(someReport());
  EXPECT_THROW(compareReports("A", "{}", "B", good), Error);
  EXPECT_THROW(compareReports("A", good, "B", "nonsense"), Error);
  EXPECT_THROW(compareReports("A", good, "B", R"({"measures":{"frame_ms":5}})"), Error);
}

TEST(Compare, CallsNothingWorseThatStraysAsFarByItself) {
  BenchReport a = someReport();
  for (const double factor : {0.9, 1.0, 1.1}) {
    a.runs.push_back(a.measures);
    a.runs.back().p50Ms *= factor;
  }
  const auto slower = [&](double factor) {
    BenchReport b = a;
    b.measures.p50Ms *= factor;
    for (BenchMeasures& run : b.runs) run.p50Ms *= factor;
    return compareReports("A", reportJson(a), "B", reportJson(b));
  };
  EXPECT_FALSE(anyWorse(slower(1.15), 0.05));
  EXPECT_FALSE(anyWorse(slower(1.21), 0.05))
      << "beyond the noise, and yet the quickest of B is quicker than the slowest of A";
  EXPECT_TRUE(anyWorse(slower(1.3), 0.05));
  EXPECT_FALSE(anyWorse(slower(1.3), 0.35));
}

TEST(Compare, AHitchInMostRunsIsNotWorseWhereTheOtherHadOneToo) {
  BenchReport a = someReport(), b = someReport();
  for (const int hitches : {0, 0, 1}) {
    a.runs.push_back(a.measures);
    a.runs.back().hitches = hitches;
    b.runs.push_back(b.measures);
    b.runs.back().hitches = 1 - hitches;
  }
  a.measures.hitches = 0;
  b.measures.hitches = 1;
  EXPECT_FALSE(anyWorse(compareReports("A", reportJson(a), "B", reportJson(b)), 0.05));
  for (BenchMeasures& run : b.runs) run.hitches = 2;
  b.measures.hitches = 2;
  EXPECT_TRUE(anyWorse(compareReports("A", reportJson(a), "B", reportJson(b)), 0.05));
}

/// Reports of flights that differ by chance alone, as on a machine where frame times stray by `stray`.
TEST(Compare, TwoRunsOfTheSameBuildAreEqualWhateverTheNoise) {
  std::mt19937 random(11);
  for (const double stray : {0.01, 0.1, 0.5}) {
    std::normal_distribution<double> factor(0.0, stray);
    int worse = 0;
    for (int trial = 0; trial < 40; ++trial) {
      BenchReport reports[2] = {someReport(), someReport()};
      for (BenchReport& report : reports) {
        report.pictures.clear();
        const BenchMeasures each = report.measures;
        for (int run = 0; run < 3; ++run) {
          const double slow = std::exp(factor(random));
          report.runs.push_back(each);
          for (double BenchMeasures::*time : {&BenchMeasures::p50Ms, &BenchMeasures::p95Ms, &BenchMeasures::p99Ms})
            report.runs.back().*time *= slow;
          report.runs.back().pointsPerSecond /= slow;
        }
        report.measures = medianMeasures(report.runs);
      }
      worse += anyWorse(compareReports("A", reportJson(reports[0]), "B", reportJson(reports[1])), 0.05) ? 1 : 0;
    }
    EXPECT_LE(worse, 2) << stray;  // 1 of 20 by Mann and Whitney 1947 for three against three: fewer for the noise
  }
}

TEST(Compare, SaysThatOthersKeptTheMachineBusy) {
  BenchReport a = someReport(), b = someReport();
  EXPECT_EQ(comparisonTable(compareReports("A", reportJson(a), "B", reportJson(b)), 0.05).find("other programs"),
            std::string::npos);
  b.measures.cpuOfOthers = 0.43;
  EXPECT_NE(comparisonTable(compareReports("A", reportJson(a), "B", reportJson(b)), 0.05)
                .find("other programs took 0 % of the machine's CPU time in A and 43 % in B"),
            std::string::npos);
}

TEST(Compare, PutsEachPairOfPicturesSideBySideWithItsPsnr) {
  const test::TempFolder folder;
  BenchReport report = someReport();
  report.pictures = {{"overview", "overview.png", false, {8, 8, std::vector<std::uint32_t>(64, 0xff102030u)}}};
  for (const char* run : {"a", "b"}) {
    makeFolder((folder / run).string());
    writeReport((folder / run).string(), report);
    writePng((folder / run / "overview.png").string(), report.pictures[0].image);
    report.pictures[0].image.pixels[5] ^= 0x40u;
  }
  const std::string a = (folder / "a").string(), b = (folder / "b").string();
  const Comparison same = compareRuns(a, a);
  ASSERT_EQ(same.pictures.size(), 1u);
  EXPECT_TRUE(std::isinf(same.pictures[0].psnr));
  const Comparison other = compareRuns(a, b);
  EXPECT_NEAR(other.pictures[0].psnr, 10.0 * std::log10(255.0 * 255.0 * 3.0 * 64.0 / (64.0 * 64.0)), 1e-9);
  const std::string html = comparisonHtml(a, b, other, 0.05);
  std::size_t pictures = 0;
  for (std::size_t at = html.find("<img"); at != std::string::npos; at = html.find("<img", at + 1)) ++pictures;
  EXPECT_EQ(pictures, 2u);
}

TEST(Psnr, OfPicturesOfOtherSizesIsNoNumber) { EXPECT_TRUE(std::isnan(psnr({1, 2, {0, 0}}, {2, 1, {0, 0}}))); }

TEST(Measures, TheMedianOfRunsIsTakenMeasureByMeasure) {
  std::vector<BenchMeasures> runs(3, measureFrames(someFrames(5)));
  runs[0].p50Ms = 5.0, runs[1].p50Ms = 7.0, runs[2].p50Ms = 6.0;
  runs[0].hitches = 4, runs[1].hitches = 0, runs[2].hitches = 1;
  EXPECT_EQ(medianMeasures(runs).p50Ms, 6.0);
  EXPECT_EQ(medianMeasures(runs).hitches, 1);
  const std::vector<MeasureNoise> noise = measureNoise(runs);
  ASSERT_FALSE(noise.empty());
  EXPECT_EQ(noise[0].name, "frame_ms p50");
  EXPECT_NEAR(noise[0].share, 2.0 / 6.0, 1e-12);
  EXPECT_TRUE(measureNoise(std::span(runs).first(1)).empty());
}

TEST(Measures, HitchesCountTheirShareOfTheTime) {
  std::vector<FrameRecord> frames(4);
  for (FrameRecord& frame : frames) frame.frameMs = 20.0;
  frames[2].frameMs = 140.0;
  frames[2].hitch = true;
  frames[0].pointsDrawn = 300;
  frames[0].pixelsCovered = 100;
  const BenchMeasures m = measureFrames(frames);
  EXPECT_NEAR(m.hitchTimeShare, 0.7, 1e-12);
  EXPECT_NEAR(m.hitchesPerMinute, 1.0 / (0.2 / 60.0), 1e-9);
  EXPECT_NEAR(m.pointsPerPixelWon, 3.0, 1e-12);
}

TEST(ImageHash, TellsPicturesApartByPixelsAndBySize) {
  const Image a{2, 1, {1, 2}}, b{1, 2, {1, 2}}, c{2, 1, {1, 3}};
  EXPECT_EQ(imageHash(a), imageHash(a));
  EXPECT_NE(imageHash(a), imageHash(b));
  EXPECT_NE(imageHash(a), imageHash(c));
  EXPECT_EQ(imageHash(a).size(), 16u);
}

}  // namespace
}  // namespace strata
