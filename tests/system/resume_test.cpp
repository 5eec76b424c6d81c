// Conversions that end early: killed, stopped or out of disk, and resumed with the same or other inputs and options.
#include <random>

#include "converter/journal/journal.h"
#include "tests/support/interrupted.h"

namespace strata::test {
namespace {

namespace fs = std::filesystem;

TEST(Resume, GivesTheSameBytesWhereverTheConversionWasKilled) { expectKillsResume(25, kScan, {}); }

TEST(Resume, GivesTheSameNormalsWhereverTheConversionWasKilled) {
  expectKillsResume(6, {"synthetic:plane?points=1e5", "synthetic:degenerate?points=5e4"}, {"--normals"});
}

TEST(Resume, ComesToItsEndThoughItIsKilledAgainAndAgain) {
  const TempFolder folder;
  const fs::path whole = folder / "whole.strata", store = folder / "killed.strata";
  const Finished undisturbed = runProgram("strata-convert", convertWords(kScan, whole, {}));
  double seconds = 0.1 * undisturbed.seconds;
  int killed = 0;
  for (;; seconds *= 1.1) {
    const Finished finished = interrupt(kScan, store, seconds, {"--resume"}, SIGKILL);
    if (fs::exists(store)) break;  // the store is complete, even if the program was killed before it said so
    ASSERT_EQ(finished.exitCode, 128 + SIGKILL) << finished.err;
    ASSERT_LT(++killed, 100);
  }
  EXPECT_GT(killed, 0);
  EXPECT_TRUE(sameStores(store, whole));
  expectNothingElse(store);
}

TEST(Resume, GoesOnAfterCtrlCWhichSaysHow) {
  const TempFolder folder;
  const fs::path whole = folder / "whole.strata", store = folder / "stopped 'n' cut.strata", temp = folder / "temp";
  fs::create_directory(temp);
  const Words options{"--temp", temp.string()};
  const Finished undisturbed = runProgram("strata-convert", convertWords(kScan, whole, options));
  EXPECT_TRUE(fs::is_empty(temp));
  int stopped = 0;
  for (const double share : {0.2, 0.4, 0.6, 0.8}) {
    const Finished finished = interrupt(kScan, store, share * undisturbed.seconds, options, SIGINT);
    if (finished.exitCode == 0) {
      fs::remove_all(store);
      continue;
    }
    ++stopped;
    expectRefused(finished, store);
    if (!fs::exists(buildingOf(store))) continue;  // it was stopped before it began
    const std::size_t at = finished.err.find("go on with: ");
    ASSERT_NE(at, std::string::npos) << finished.err;
    const std::string command = finished.err.substr(at + 12);
    EXPECT_EQ(std::distance(fs::directory_iterator(temp), {}), 1);
    const Finished last = runProgram("/bin/sh", {"-c", command});
    ASSERT_EQ(last.exitCode, 0) << last.err << command;
    EXPECT_TRUE(sameStores(store, whole));
    EXPECT_TRUE(fs::is_empty(temp));
    expectNothingElse(store);
    fs::remove_all(store);
  }
  EXPECT_GT(stopped, 0);
}

TEST(Resume, IsRefusedWithOtherOptionsThatDecideTheBytes) {
  const TempFolder folder;
  const fs::path store = folder / "a.strata";
  leaveInterrupted(kScan, store);
  const Finished memory =
      runProgram("strata-convert", {kScan[0], kScan[1], "-o", store.string(), "--memory", "600M", "--resume"});
  expectRefused(memory, store);
  EXPECT_TRUE(mentions(memory, "--memory")) << memory.err;
  const Finished capacity =
      runProgram("strata-convert", convertWords(kScan, store, {"--resume", "--node-points", "2000"}));
  expectRefused(capacity, store);
  EXPECT_TRUE(mentions(capacity, "--node-points")) << capacity.err;
  const Finished input = runProgram("strata-convert", convertWords({kScan[0]}, store, {"--resume"}));
  expectRefused(input, store);
  EXPECT_TRUE(mentions(input, kScan[1])) << input.err;
  EXPECT_EQ(runProgram("strata-convert", convertWords(kScan, store, {"--resume", "--threads", "1"})).exitCode, 0);
}

TEST(Resume, NamesTheInputThatChangedOrIsGone) {
  const TempFolder folder;
  const fs::path store = folder / "a.strata", scan = folder / "scan.las";
  LasSpec spec;
  spec.points = gridPoints(1500);
  writeLas(scan, spec);
  const std::string before = readWhole(scan);
  leaveInterrupted({scan.string()}, store);
  EXPECT_EQ(readWhole(scan), before);
  fs::last_write_time(scan, fs::last_write_time(scan) + std::chrono::seconds(1));
  const Finished touched = runProgram("strata-convert", convertWords({scan.string()}, store, {"--resume"}));
  expectRefused(touched, store);
  EXPECT_TRUE(mentions(touched, scan.string())) << touched.err;
  fs::remove(scan);
  const Finished gone = runProgram("strata-convert", convertWords({scan.string()}, store, {"--resume"}));
  expectRefused(gone, store);
  EXPECT_TRUE(mentions(gone, scan.string())) << gone.err;
  EXPECT_TRUE(fs::exists(buildingOf(store) / "journal"));  // the attempt has cost nothing
}

TEST(Resume, IsOfferedAndForceStartsAgain) {
  const TempFolder folder;
  const fs::path store = folder / "a.strata", temp = folder / "temp";
  fs::create_directory(temp);
  leaveInterrupted(kScan, store, {"--temp", temp.string()});
  const Finished plain = runProgram("strata-convert", convertWords(kScan, store, {}));
  expectRefused(plain, store);
  EXPECT_TRUE(mentions(plain, "--resume") && mentions(plain, "--force")) << plain.err;
  const Finished again =
      runProgram("strata-convert", convertWords({"synthetic:plane?points=1000"}, store, {"--force"}));
  EXPECT_EQ(again.exitCode, 0) << again.err;
  EXPECT_TRUE(fs::is_empty(temp));
  expectNothingElse(store);
}

TEST(Resume, ReadsAgainWhatTheJournalLost) {
  const TempFolder folder;
  const fs::path whole = folder / "whole.strata", store = folder / "a.strata", journal = buildingOf(store) / "journal";
  const Finished undisturbed = runProgram("strata-convert", convertWords(kScan, whole, {}));
  const auto lastIsRuns = [&] {
    if (!fs::exists(journal)) return false;
    fs::copy_file(journal, folder / "copy", fs::copy_options::overwrite_existing);
    const Journal copy((folder / "copy").string());
    return !copy.found().empty() && copy.found().back().kind == RecordKind::runs;
  };
  for (int attempt = 0; !lastIsRuns(); ++attempt) {
    ASSERT_LT(attempt, 100);
    fs::remove_all(store);
    fs::remove_all(buildingOf(store));
    interrupt(kScan, store, (0.05 + 0.01 * (attempt % 50)) * undisturbed.seconds, {}, SIGKILL);
  }
  fs::resize_file(journal, fs::file_size(journal) - 1);
  const Finished finished = runProgram("strata-convert", convertWords(kScan, store, {"--resume"}));
  ASSERT_EQ(finished.exitCode, 0) << finished.err;
  EXPECT_TRUE(sameStores(store, whole));
  expectNothingElse(store);
}

TEST(Resume, FindsOutWhatIsDamagedAndRefusesOrDoesItAgain) {
  const TempFolder folder;
  const fs::path whole = folder / "whole.strata", store = folder / "a.strata";
  const Finished undisturbed = runProgram("strata-convert", convertWords(kScan, whole, {}));
  std::mt19937 random(11);
  for (const char* name : {"journal", "spill", "points.bin"})
    for (const double share : {0.3, 0.8}) {
      while (!fs::exists(buildingOf(store) / "journal")) {
        fs::remove_all(store);
        interrupt(kScan, store, share * undisturbed.seconds, {}, SIGKILL);
      }
      const fs::path file = buildingOf(store) / name;
      std::string bytes = fs::exists(file) ? readWhole(file) : std::string();
      for (int i = 0; i < 20 && !bytes.empty(); ++i) bytes[random() % bytes.size()] ^= 0x10;
      if (!bytes.empty()) writeBytes(file, bytes);
      const Finished finished = runProgram("strata-convert", convertWords(kScan, store, {"--resume"}));
      if (finished.exitCode == 0)
        EXPECT_TRUE(sameStores(store, whole)) << name;
      else
        expectRefused(finished, store);
      fs::remove_all(store);
      fs::remove_all(buildingOf(store));
    }
}

TEST(Resume, WithNothingToResumeIsAPlainConversion) {
  const TempFolder folder;
  const fs::path store = folder / "a.strata";
  EXPECT_EQ(runProgram("strata-convert", convertWords({"synthetic:plane?points=1000"}, store, {"--resume"})).exitCode,
            0);
  expectNothingElse(store);
}

}  // namespace
}  // namespace strata::test
