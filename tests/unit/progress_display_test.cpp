#include "converter/programs/progress_display.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "converter/programs/conversion_summary.h"
#include "tests/support/test_data.h"

namespace strata {
namespace {

constexpr std::uint64_t kPoints = 100'000'000;

double leftAt(const char* stage, std::uint64_t done, double stageSeconds, int threads = 2) {
  return secondsLeft({stage, done, kPoints}, stageSeconds, kPoints, threads).value();
}

TEST(TimeLeft, IsUnknownWhileTheNumberOfPointsIs) {
  EXPECT_FALSE(secondsLeft({stage::kSurvey, 0, 0}, 3.0, 0, 2));
  EXPECT_FALSE(secondsLeft({"", 0, 0}, 3.0, kPoints, 2));
}

TEST(TimeLeft, FollowsTheRunningStagesOwnRateAndAddsTheStagesToCome) {
  // A quarter read in 10 s: 30 s more, and what comes after reading.
  const double afterReading = leftAt(stage::kDistribute, kPoints, 40.0);
  EXPECT_GT(afterReading, 10.0);
  EXPECT_NEAR(leftAt(stage::kDistribute, kPoints / 4, 10.0), 30.0 + afterReading, 1e-6);
  EXPECT_NEAR(leftAt(stage::kDistribute, kPoints / 4, 100.0), 300.0 + afterReading, 1e-6);
}

TEST(TimeLeft, FallsFromStageToStageToNothing) {
  double before = 1e300;
  for (const char* stage : {stage::kMeasure, stage::kDistribute, stage::kBuild, stage::kMerge, stage::kWrite}) {
    const double begin = leftAt(stage, 0, 0.0), end = leftAt(stage, kPoints, 1.0);
    EXPECT_LT(begin, before) << stage;
    EXPECT_LE(end, begin) << stage;
    before = end + 1e-9;
  }
  EXPECT_EQ(leftAt(stage::kWrite, kPoints, 1.0), 0.0);
}

TEST(TimeLeft, OfStagesToComeHalvesWithTwiceTheThreads) {
  EXPECT_NEAR(leftAt(stage::kBuild, 0, 0.0, 4), leftAt(stage::kBuild, 0, 0.0, 2) / 2, 1e-9);
}

TEST(TimeLeft, IsNeverNegativeHoweverLongAStageTakes) {
  EXPECT_GE(leftAt(stage::kMerge, 0, 2.0), 0.0);
  EXPECT_GE(leftAt(stage::kWrite, kPoints, 1e6), 0.0);
  EXPECT_FALSE(secondsLeft({stage::kWrite, 0, 0}, 60.0, kPoints, 2)) << "a late stage that says nothing";
}

TEST(ProgressText, SaysStagePointsRateMemoryAndTimeLeftWithinEightyColumns) {
  const std::string line =
      progressLine({stage::kDistribute, 206'000'000, 500'000'000, 12.34e6, std::uint64_t{512} << 20, 20.0, 103.0});
  for (const char* part : {"distribute", "41 %", "206.0/500.0 M points", "12.3 M/s", "512 MiB", "1 min 43 s left"})
    EXPECT_NE(line.find(part), std::string::npos) << part << " is not in: " << line;
  EXPECT_LE(progressLine(
                {stage::kDistribute, 12'345'678'901, 50'000'000'000, 12.34e6, std::uint64_t{63} << 30, 20.0, 359999.0})
                .size(),
            80u);
  EXPECT_NE(progressLine({stage::kSurvey, 0, 0, 0.0, 0, 7.0, {}}).find("7 s so far"), std::string::npos);
}

TEST(ProgressText, DurationsAreReadAtAGlance) {
  EXPECT_EQ(durationText(0.2), "1 s");
  EXPECT_EQ(durationText(43), "43 s");
  EXPECT_EQ(durationText(750), "12 min 30 s");
  EXPECT_EQ(durationText(7800), "2 h 10 min");
}

/// Waits until the display has written `more` lines.
void waitForLines(const std::string& path, int more) {
  const auto lines = [&] {
    std::ifstream in(path);
    return std::count(std::istreambuf_iterator<char>(in), {}, '\n');
  };
  const auto wanted = lines() + more;
  for (int i = 0; i < 10000 && lines() < wanted; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

/// What a display writes to a file for the events given.
std::string shown(ProgressDisplay::Style style, const std::vector<Progress>& events) {
  const test::TempFolder folder;
  const std::string path = (folder / "shown").string();
  std::FILE* out = std::fopen(path.c_str(), "w");
  {
    ProgressDisplay display(style, out, 2, std::chrono::milliseconds(1));
    for (const Progress& event : events) {
      display.update(event);
      waitForLines(path, 2);  // the first may have been on its way before
    }
  }
  std::fclose(out);
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(ProgressDisplay, WritesJsonLinesThatProgramsCanRead) {
  const std::string text = shown(ProgressDisplay::Style::json, {{stage::kDistribute, 250, 1000}});
  ASSERT_FALSE(text.empty());
  const auto json = nlohmann::json::parse(text.substr(0, text.find('\n')));
  EXPECT_EQ(json.at("progress"), "distribute");
  EXPECT_EQ(json.at("points_done"), 250);
  EXPECT_EQ(json.at("points_total"), 1000);
  EXPECT_GT(json.at("memory_bytes"), 1 << 20);
  EXPECT_GE(json.at("seconds_left"), 0.0);
}

TEST(ProgressDisplay, ReportsThatArriveOutOfOrderDoNotTurnItBack) {
  const std::string text = shown(ProgressDisplay::Style::lines,
                                 {{stage::kBuild, 900, 1000}, {stage::kBuild, 300, 1000}, {stage::kMerge, 0, 0}});
  EXPECT_NE(text.find("90 %"), std::string::npos) << text;
  EXPECT_EQ(text.find("30 %"), std::string::npos) << text;
  EXPECT_NE(text.find("merge"), std::string::npos) << text;
}

TEST(ProgressDisplay, SaysNothingBeforeTheFirstIntervalIsOver) {
  const test::TempFolder folder;
  const std::string path = (folder / "shown").string();
  std::FILE* out = std::fopen(path.c_str(), "w");
  { ProgressDisplay(ProgressDisplay::Style::lines, out, 2).update({stage::kBuild, 1, 2}); }
  std::fclose(out);
  EXPECT_EQ(std::ifstream(path).peek(), std::ifstream::traits_type::eof());
}

TEST(Summary, NamesEveryStageLevelAndPlaneInAboutTwentyLines) {
  ConvertReport report;
  report.points = 1000;
  report.nodes = 9;
  report.outputBytes = 8000;
  for (const char* name : {stage::kSurvey, stage::kDistribute, stage::kBuild, stage::kMerge, stage::kWrite})
    report.stages.push_back({name, 1.5, 2.5});
  report.nodesByLevel = {1, 8};
  for (int i = 0; i < 15; ++i)
    report.planes.push_back({"plane " + std::to_string(i), static_cast<std::uint64_t>(100 - i), 100});
  const std::string text = summaryText("a.strata", report, {7.5, 12.5, 1 << 20});
  for (const char* part : {"a.strata", "distribute", "0: 1, 1: 8", "plane 0", "others", "0.10 of"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " is not in:\n" << text;
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 20);
  const auto json = nlohmann::json::parse(summaryJson(report, {7.5, 12.5, 1 << 20}));
  EXPECT_EQ(json.at("stage_cpu_seconds").at("build"), 2.5);
  EXPECT_EQ(json.at("planes").at("plane 14").at("stored_bytes"), 86);
}

}  // namespace
}  // namespace strata
