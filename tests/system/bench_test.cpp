// The output of strata-bench: the trace, the page, the tables of the papers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <tuple>

#include "core/image.h"
#include "tests/support/paths.h"
#include "tests/support/programs.h"

namespace strata::test {
namespace {

constexpr const char* kChromium = "/usr/bin/chromium";

class Bench : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    mustConvert({"synthetic:city?points=200000&seed=1"}, city(), {"--node-points", "4096"});
    const Finished made = runProgram("strata-bench", {"--make-path", "dive", city().string()});
    Json path = Json::parse(made.out);
    for (Json& key : path["keys"]) key["t"] = key["t"].get<double>() / 16.0;
    path["keys"].front()["mark"] = true;
    std::ofstream(file("dive.json")) << path;
    const Finished flown = fly("flight", {"--loader-threads", "2", "--size", "320x180", "--stills"});
    if (flown.exitCode != 0) throw std::runtime_error("strata-bench failed: " + flown.err);
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::filesystem::path city() { return *folder_ / "city.strata"; }
  static std::filesystem::path file(const std::string& name) { return *folder_ / name; }

  static Finished fly(const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> all{city().string(), "--path", file("dive.json").string(), "-o", file(out).string(),
                                 "--backend",     "cpu"};
    all.insert(all.end(), more.begin(), more.end());
    return runProgram("strata-bench", all);
  }
  static Json report(const std::string& run) { return Json::parse(readWhole(file(run) / "report.json")); }

  /// The values of one column of frames.csv.
  static std::vector<double> column(const std::string& run, const std::string& name) {
    std::ifstream csv(file(run) / "frames.csv");
    const auto cells = [](const std::string& line) {
      std::vector<std::string> parts;
      std::istringstream in(line);
      for (std::string part; std::getline(in, part, ',');) parts.push_back(part);
      return parts;
    };
    std::string line;
    std::getline(csv, line);
    const std::vector<std::string> names = cells(line);
    const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    std::vector<double> values;
    while (std::getline(csv, line)) values.push_back(std::stod(cells(line).at(at)));
    return values;
  }

 private:
  static TempFolder* folder_;
};
TempFolder* Bench::folder_ = nullptr;

// --- trace.json

struct Span {
  std::string name, parent;
  double begin, end;  ///< microseconds
  Json args;
};

/// The spans by the name of their thread. `parent` is the span around a span.
std::map<std::string, std::vector<Span>> spansOf(const Json& trace) {
  std::map<int, std::string> threads;
  std::map<std::string, std::vector<Span>> spans, open;
  for (const Json& event : trace.at("traceEvents")) {
    if (event.at("ph") == "M") {
      if (event.at("name") == "thread_name") {
        threads[event.at("tid")] = event.at("args").at("name");
        spans[event.at("args").at("name")];
      }
      continue;
    }
    EXPECT_EQ(event.at("ph"), "X");
    const std::string& thread = threads.at(event.at("tid"));
    const double begin = event.at("ts");
    Span span{event.at("name"), "", begin, begin + event.at("dur").get<double>(), event.value("args", Json::object())};
    std::vector<Span>& around = open[thread];
    while (!around.empty() && around.back().end <= span.begin + 5e-4 && around.back().end < span.end) around.pop_back();
    if (!around.empty()) {
      span.parent = around.back().name;
      EXPECT_LE(span.end, around.back().end + 2e-3) << span.name << " leaves " << span.parent;
    }
    around.push_back(span);
    spans[thread].push_back(span);
  }
  return spans;
}

TEST_F(Bench, TheTraceHasEveryThreadsSpansInOrderAndNested) {
  const auto spans = spansOf(Json::parse(readWhole(file("flight") / "trace.json")));
  std::map<std::string, std::set<std::string>> names;  // "frame in draw and measure"
  for (const auto& [thread, list] : spans) {
    double before = 0.0;
    for (const Span& span : list) {
      EXPECT_GE(span.begin, before) << thread << " " << span.name;
      EXPECT_GE(span.end, span.begin) << thread << " " << span.name;
      before = span.begin;
      names[thread.substr(0, thread.find(' '))].insert(span.name + (span.parent.empty() ? "" : " in " + span.parent));
    }
  }
  EXPECT_TRUE(spans.contains("loader 1") && spans.contains("loader 2") && spans.size() == 4);
  EXPECT_EQ(names["LOD"],
            (std::set<std::string>{"LOD pass", "coarse depth in LOD pass", "select in LOD pass",
                                   "build the list in LOD pass", "look ahead in LOD pass", "publish in LOD pass"}));
  EXPECT_EQ(names["loader"], (std::set<std::string>{"read", "decode"}));
  EXPECT_EQ(names["render"],
            (std::set<std::string>{"first view", "place the camera", "draw and measure", "frame in draw and measure",
                                   "take the render list in frame", "draw in frame", "rasterize in draw",
                                   "resolve in draw", "keep pictures", "wait for the next frame", "write pictures"}));
}

TEST_F(Bench, TheTraceCoversEveryFrameAndEveryByteRead) {
  const auto spans = spansOf(Json::parse(readWhole(file("flight") / "trace.json")));
  const std::vector<double> frameMs = column("flight", "frame_ms");
  ASSERT_GT(frameMs.size(), 5u);
  std::size_t frame = 0;
  double within = 0.0;
  for (const Span& span : spans.at("render")) {
    if (span.parent == "frame") within += span.end - span.begin;
    if (span.name != "frame") continue;
    ASSERT_LT(frame, frameMs.size());
    EXPECT_EQ(span.args.at("frame"), frame);
    EXPECT_NEAR(1e-3 * (span.end - span.begin), frameMs[frame], 1e-3);
    ++frame;
  }
  EXPECT_EQ(frame, frameMs.size());
  double all = 0.0;
  for (const double ms : frameMs) all += ms;
  EXPECT_NEAR(1e-3 * within, all, 1e-2 * all);
  double bytes = 0.0, decoded = 0.0;
  for (const char* thread : {"loader 1", "loader 2"})
    for (const Span& span : spans.at(thread)) {
      if (span.name == "read") bytes += span.args.at("bytes").get<double>();
      if (span.name == "decode") decoded += 1.0;
    }
  const Json counters = report("flight").at("counters");
  EXPECT_GE(bytes, counters.at("bytes read").get<double>());
  EXPECT_GE(decoded, counters.at("nodes loaded").get<double>());
  EXPECT_GT(decoded, 0.0);
}

TEST_F(Bench, WithoutTheOptionThereIsNoTrace) {
  ASSERT_EQ(fly("untraced", {"--size", "160x90", "--no-trace"}).exitCode, 0);
  EXPECT_FALSE(std::filesystem::exists(file("untraced") / "trace.json"));
}

// --- measures

TEST_F(Bench, TheWidestSpacingIsThatOfThePointsPerPixelAndMoreWhereTheBudgetEnds) {
  ASSERT_EQ(fly("whole", {"--size", "320x180", "--settle", "--occlusion", "off"}).exitCode, 0);
  ASSERT_EQ(fly("scarce", {"--size", "320x180", "--settle", "--occlusion", "off", "--point-budget", "20000"}).exitCode,
            0);
  const std::vector<double> whole = column("whole", "widest_spacing_px");
  const std::vector<double> scarce = column("scarce", "widest_spacing_px");
  ASSERT_EQ(whole.size(), scarce.size());
  const double promised = 1.0 / std::sqrt(1.8);
  std::vector<double> sorted = whole;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_NEAR(sorted[sorted.size() / 2], promised, 1e-2);
  EXPECT_LE(sorted.back(), 1.1 * promised);  // small nodes are rounded to whole points
  EXPECT_GE(*std::min_element(scarce.begin(), scarce.end()), promised - 1e-3);
  EXPECT_GT(*std::max_element(scarce.begin(), scarce.end()), 1.2 * promised);
}

TEST_F(Bench, TheReportSaysWhatWasInThePageCache) {
  ASSERT_EQ(fly("cold", {"--size", "160x90", "--cold"}).exitCode, 0);
  const std::string cold = report("cold").at("options").at("page cache");
  EXPECT_EQ(cold.find("cold: points.bin dropped (posix_fadvise), "), 0u) << cold;
  const std::string warm = report("flight").at("options").at("page cache");
  EXPECT_EQ(warm.find("left as it was: "), 0u) << warm;
  EXPECT_GT(report("flight").at("measures").at("points_read_per_pixel").get<double>(), 0.0);
}

// --- report.html in a browser

/// The picture that headless Chromium makes of the flight's page in a window of this size; empty where it fails.
Image pageIn(const std::filesystem::path& page, const std::string& png, int width, int height) {
  const std::filesystem::path profile = page.parent_path() / "profile";
  const Finished shown = runProgram(
      kChromium, {"--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run",
                  "--user-data-dir=" + profile.string(), "--screenshot=" + png,
                  "--window-size=" + std::to_string(width) + "," + std::to_string(height), "file://" + page.string()});
  return shown.exitCode == 0 && std::filesystem::exists(png) ? readPng(png) : Image{};
}

/// The share of a column of pixels that differs from the colour of the paper.
double inkAt(const Image& image, int x) {
  int ink = 0;
  for (int y = 0; y < image.height; ++y) {
    const std::uint32_t pixel =
        image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)];
    ink += pixel != image.pixels[0] ? 1 : 0;
  }
  return static_cast<double>(ink) / image.height;
}

/// The number of rows from the top to the last one that is not empty.
int inkedHeight(const Image& image) {
  for (std::size_t i = image.pixels.size(); i > 0; --i)
    if (image.pixels[i - 1] != image.pixels[0])
      return static_cast<int>((i - 1) / static_cast<std::size_t>(image.width));
  return 0;
}

TEST_F(Bench, ABrowserShowsTheReportOnADeskAndOnAPhoneWithNothingBeyondTheEdge) {
  if (!std::filesystem::exists(kChromium)) GTEST_SKIP() << kChromium << " is not there";
  const std::filesystem::path page = file("flight") / "report.html";
  for (const auto& [name, width, height] : {std::tuple{"desk", 1200, 6000}, std::tuple{"phone", 390, 9000}}) {
    const Image image = pageIn(page, file(std::string(name) + ".png").string(), width, height);
    ASSERT_EQ(image.width, width);
    // Pictures, plots and text have thousands of colours, and the long page ends within the window.
    EXPECT_GT(std::set<std::uint32_t>(image.pixels.begin(), image.pixels.end()).size(), 1000u) << name;
    EXPECT_GT(inkedHeight(image), 3000) << name;
    EXPECT_LT(inkedHeight(image), height - 10) << name;
    // The margins are empty, so nothing is cut off.
    for (const int x : {0, 1, 2, 3, width - 4, width - 3, width - 2, width - 1}) EXPECT_EQ(inkAt(image, x), 0.0) << x;
    EXPECT_GT(inkAt(image, width / 2), 0.2) << name;
  }
}

TEST_F(Bench, ABrowserPrintsTheReport) {
  if (!std::filesystem::exists(kChromium)) GTEST_SKIP() << kChromium << " is not there";
  const std::filesystem::path pdf = file("report.pdf");
  const Finished printed =
      runProgram(kChromium, {"--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
                             "--user-data-dir=" + file("profile").string(), "--no-pdf-header-footer",
                             "--print-to-pdf=" + pdf.string(), "file://" + (file("flight") / "report.html").string()});
  ASSERT_EQ(printed.exitCode, 0) << printed.err;
  const std::string text = readWhole(pdf);
  std::size_t pages = 0;
  for (std::size_t at = text.find("/Type /Page\n"); at != std::string::npos; at = text.find("/Type /Page\n", at + 1))
    ++pages;
  EXPECT_GE(pages, 2u);
  EXPECT_LE(pages, 12u);
}

// --- docs/benchmarks.md and docs/benchmarks/

/// The sections that tests/bench/all.sh measures into pages of their own.
const std::vector<std::string> kSections{"conversion", "larger",      "store",       "selection", "loading",
                                         "streaming",  "rasterizers", "progressive", "kanzok",    "schuetz",
                                         "guenther",   "flights",     "real",        "filling",   "largest"};

/// Copies the benchmark pages into `folder`, where all.sh may write into them.
void copyPages(const std::filesystem::path& folder) {
  std::filesystem::create_directory(folder);
  std::filesystem::copy_file(sourceFolder() / "docs/benchmarks.md", folder / "benchmarks.md");
  std::filesystem::copy(sourceFolder() / "docs/benchmarks", folder / "benchmarks");
}

/// The lines between a section's marks; empty with a failed expectation where the marks are missing.
std::string markedPart(const std::string& text, const std::string& section) {
  const std::string mark = "<!-- " + section + ": tests/bench/all.sh " + section + " -->\n";
  const std::size_t begin = text.find(mark), end = text.find("<!-- end of " + section + " -->");
  EXPECT_TRUE(begin != std::string::npos && end != std::string::npos && begin < end) << "no marks of " << section;
  if (begin == std::string::npos || end == std::string::npos || end < begin) return {};
  return text.substr(begin + mark.size(), end - begin - mark.size());
}

/// Expects that no table and nothing measured lies outside of the marks.
void expectOnlyWordsOutsideTheMarks(const std::string& text) {
  static const std::regex measured("[0-9] ?(%|(s|ms|µs|ns|[GM]B|[GM]iB|[GM]B/s|times|points/s)([^A-Za-z/]|$))");
  bool inside = false;
  for (const std::string& line : linesOf(text)) {
    if (line.starts_with("<!-- ")) inside = !line.starts_with("<!-- end of ");
    EXPECT_TRUE(inside || !(line.starts_with("|") || std::regex_search(line, measured))) << line;
  }
}

TEST_F(Bench, EveryFigureOfTheBenchmarkPagesLiesBetweenTheMarksOfASection) {
  if (!std::filesystem::exists("/usr/bin/python3")) GTEST_SKIP() << "python3 is not there";
  const std::filesystem::path docs = file("docs");
  copyPages(docs);
  const Finished done = runProgram((sourceFolder() / "tests/bench/all.sh").string(),
                                   {"-b", programFolder().parent_path().string(), "-d", file("all").string(), "-o",
                                    docs.string(), "-q", "machine", "targets"});
  ASSERT_EQ(done.exitCode, 0) << done.err;
  const std::string page = readWhole(docs / "benchmarks.md");
  EXPECT_NE(markedPart(page, "machine").find("**Machine**: "), std::string::npos);
  EXPECT_NE(
      markedPart(page, "targets").find("| convert LAS, largest size | not measured | 5 M points/s | 9 M points/s |"),
      std::string::npos);
  expectOnlyWordsOutsideTheMarks(page);
  for (const std::string& section : kSections) {
    EXPECT_NE(markedPart(page, section), "") << section;
    EXPECT_NE(page.find("(benchmarks/" + section + ".md)"), std::string::npos) << section;
    const std::string tables = readWhole(docs / "benchmarks" / (section + ".md"));
    EXPECT_NE(markedPart(tables, section).find("| "), std::string::npos) << section;
    expectOnlyWordsOutsideTheMarks(tables);
  }
}

TEST_F(Bench, TheMainFiguresOfThePageAreThoseOfTheTables) {
  if (!std::filesystem::exists("/usr/bin/python3")) GTEST_SKIP() << "python3 is not there";
  const std::string page = readWhole(sourceFolder() / "docs/benchmarks.md");
  const auto words = [](const std::string& text) {
    std::istringstream in(text);
    std::vector<std::string> all;
    for (std::string word; in >> word;) all.push_back(word);
    return all;
  };
  for (const std::string& section : kSections) {
    const std::string tables = (sourceFolder() / "docs/benchmarks" / (section + ".md")).string();
    const Finished made = runProgram(
        "/usr/bin/python3", {(sourceFolder() / "tests/bench/tables.py").string(), "headline", section, tables});
    ASSERT_EQ(made.exitCode, 0) << made.err;
    EXPECT_EQ(words(markedPart(page, section)), words(made.out)) << section;
    EXPECT_EQ(made.out.find("Not measured"), std::string::npos) << section;
  }
}

TEST_F(Bench, TheSectionOfProgressiveDrawingIsWritten) {
  if (!std::filesystem::exists("/usr/bin/python3")) GTEST_SKIP() << "python3 is not there";
  const std::filesystem::path docs = file("progressive_docs");
  copyPages(docs);
  const Finished done = runProgram(
      "/usr/bin/env", {"RED_ROCKS=" + file("none").string(), (sourceFolder() / "tests/bench/all.sh").string(), "-b",
                       programFolder().parent_path().string(), "-d", file("progressive").string(), "-o", docs.string(),
                       "-q", "progressive"});
  ASSERT_EQ(done.exitCode, 0) << done.err;
  const std::string section = markedPart(readWhole(docs / "benchmarks/progressive.md"), "progressive");
  for (const char* table :
       {"| pool | perfect shuffle | keyed |", "| whole nodes |", "| pieces |", "| 99 % |", "| reproject |", "| turn |",
        "| everything, compute32 |", "written into a full pool |", "| progressive 0.02 M |"})
    EXPECT_NE(section.find(table), std::string::npos) << table << " in\n" << section;
  EXPECT_NE(section.find(" 0 % |\n\nSource: "), std::string::npos) << "a wrong pixel in\n" << section;
  const std::string headline = markedPart(readWhole(docs / "benchmarks.md"), "progressive");
  EXPECT_EQ(headline.find("A frame of "), 0u) << headline;
  EXPECT_NE(headline.find(" points: "), std::string::npos) << headline;
}

TEST_F(Bench, ConversionsMeasuredOneByOneShareTheirTables) {
  if (!std::filesystem::exists("/usr/bin/python3")) GTEST_SKIP() << "python3 is not there";
  const auto convert = [](const std::string& size) {
    return runProgram((sourceFolder() / "tests/bench/convert.sh").string(),
                      {"-b", programFolder().parent_path().string(), "-d", file("scans").string(), "-s",
                       file("measured").string(), "-r", "1", "-n", size});
  };
  ASSERT_EQ(convert("20k").exitCode, 0);
  const Finished done = convert("10k:512M");
  ASSERT_EQ(done.exitCode, 0) << done.err;
  std::vector<std::string> starts;
  for (const std::string& line : linesOf(done.out))
    if (line.starts_with("| 10k | LA") || line.starts_with("| 20k | LA")) starts.push_back(line.substr(0, 20));
  const std::vector<std::string> both{"| 10k | LAS | 512M |", "| 10k | LAZ | 512M |", "| 20k | LAS | 2G | 0",
                                      "| 20k | LAZ | 2G | 0"};
  std::vector<std::string> twice = both;  // the table of totals, then that of the stages
  twice.insert(twice.end(), both.begin(), both.end());
  ASSERT_EQ(starts.size(), twice.size()) << done.out;
  for (std::size_t i = 0; i < twice.size(); ++i) EXPECT_EQ(starts[i].substr(0, 17), twice[i].substr(0, 17));
  EXPECT_TRUE(std::filesystem::is_empty(file("scans")));
}

// --- the papers' tables

/// The rows of every table, without the header and the line under it. Expects each row to have one cell for every cell
/// of the header.
std::vector<std::vector<std::string>> tableRows(const std::string& markdown) {
  std::vector<std::vector<std::string>> rows;
  std::size_t columns = 0;
  for (const std::string& line : linesOf(markdown)) {
    if (!line.starts_with("| ")) {
      if (!line.starts_with("|-")) columns = 0;
      continue;
    }
    std::vector<std::string> cells;
    std::istringstream in(line.substr(2));
    for (std::string cell; std::getline(in, cell, '|');)
      cells.push_back(cell.substr(0, cell.find_last_not_of(' ') + 1));
    if (columns == 0)
      columns = cells.size();
    else
      rows.push_back(cells);
    EXPECT_EQ(cells.size(), columns) << line;
  }
  return rows;
}

struct Suite {
  const char* name;
  const char* scale;
  std::size_t rows;                   ///< the least number
  std::vector<std::string> hardware;  ///< the paper's
};

TEST_F(Bench, EachSuitePrintsItsTablesBesideThePapers) {
  for (const Suite& suite : {Suite{"kanzok", "1e-4", 24, {"GTX 680"}}, Suite{"schuetz", "2e-4", 40, {"RTX 3090"}},
                             Suite{"guenther", "2e-4", 14, {"HD 7970"}}}) {
    const Finished done = runProgram(
        "paper_suites", {"--suite", suite.name, "--suite-scale", suite.scale, "--size", "160x90", "--backend", "cpu"});
    ASSERT_EQ(done.exitCode, 0) << done.err;
    const auto rows = tableRows(done.out);
    EXPECT_GE(rows.size(), suite.rows) << done.out;
    const auto ofPaper = std::count_if(rows.begin(), rows.end(), [](const auto& row) { return row[0][0] == '*'; });
    EXPECT_GE(ofPaper, suite.name == std::string("guenther") ? 1 : 10) << done.out;
    for (const std::string& hardware : suite.hardware) EXPECT_NE(done.out.find(hardware), std::string::npos);
    EXPECT_EQ(done.out.find("nan"), std::string::npos) << done.out;
    EXPECT_EQ(done.out.find("inf "), std::string::npos) << done.out;
  }
}

TEST_F(Bench, ASuiteTakesNoStore) {
  expectUsageError(runProgram("paper_suites", {city().string(), "--suite", "kanzok"}));
  expectUsageError(runProgram("paper_suites", {"--suite", "nobody"}));
  expectUsageError(runProgram("paper_suites", {}));
}

}  // namespace
}  // namespace strata::test
