#pragma once
#include <algorithm>
#include <random>

#include "tests/support/programs.h"

namespace strata::test {

using Words = std::vector<std::string>;

/// Several chunks, a cell that is split, more than one pass over the parts.
inline const Words kScan{"synthetic:plane?points=1.2e6", "synthetic:degenerate?points=9e5"};

inline Words convertWords(const Words& inputs, const std::filesystem::path& store, const Words& options) {
  Words words = inputs;
  words.insert(words.end(), {"-o", store.string(), "--memory", "512M"});
  words.insert(words.end(), options.begin(), options.end());
  return words;
}

inline std::filesystem::path buildingOf(const std::filesystem::path& store) { return store.string() + ".building"; }

/// Nothing but the store is there.
inline void expectNothingElse(const std::filesystem::path& store) {
  EXPECT_FALSE(std::filesystem::exists(buildingOf(store)));
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(store))
    EXPECT_TRUE(entry.path().filename() == "store.json" || entry.path().filename() == "points.bin" ||
                entry.path().filename() == "hierarchy.bin")
        << entry.path();
}

/// Sends the signal after a share of the time that the whole conversion took.
inline Finished interrupt(const Words& inputs, const std::filesystem::path& store, double seconds, const Words& options,
                          int signal) {
  RunOptions run;
  run.killAfterSeconds = std::max(seconds, 1e-3);
  run.signal = signal;
  return runProgram("strata-convert", convertWords(inputs, store, options), run);
}

/// Begins a conversion that is stopped on its way.
inline void leaveInterrupted(const Words& inputs, const std::filesystem::path& store, const Words& options = {}) {
  for (double seconds = 0.2; !std::filesystem::exists(buildingOf(store) / "journal"); seconds *= 1.5) {
    std::filesystem::remove_all(store);
    ASSERT_LT(seconds, 60.0);
    interrupt(inputs, store, seconds, options, SIGKILL);
  }
}

inline void expectKillsResume(int kills, const Words& inputs, const Words& options) {
  const TempFolder folder;
  const std::filesystem::path whole = folder / "whole.strata", store = folder / "killed.strata";
  const Finished undisturbed = runProgram("strata-convert", convertWords(inputs, whole, options));
  ASSERT_EQ(undisturbed.exitCode, 0) << undisturbed.err;
  std::mt19937 random(7);
  int killed = 0;
  for (int i = 0; i < kills; ++i) {
    // Spread over the whole run, so that every stage gets its share.
    const double share = (i + std::uniform_real_distribution<>(0.0, 1.0)(random)) / kills;
    const Finished first = interrupt(inputs, store, share * undisturbed.seconds, options, SIGKILL);
    if (std::filesystem::exists(store)) {  // it was faster
      ASSERT_TRUE(sameStores(store, whole)) << "killed after " << share << " of the run";
      std::filesystem::remove_all(store);
      continue;
    }
    ASSERT_NE(first.exitCode, 0);
    ++killed;
    Words again = options;
    again.push_back("--resume");
    if (i % 3 == 0) interrupt(inputs, store, 0.3 * undisturbed.seconds, again, SIGKILL);  // once more
    const char* threads = i % 2 == 0 ? "1" : "3";
    if (!std::filesystem::exists(store)) {
      again.insert(again.end(), {"--threads", threads});
      const Finished last = runProgram("strata-convert", convertWords(inputs, store, again));
      ASSERT_EQ(last.exitCode, 0) << last.err << " after " << share << " of the run";
    }
    ASSERT_TRUE(sameStores(store, whole)) << "killed after " << share << " of the run";
    expectNothingElse(store);
    std::filesystem::remove_all(store);
  }
  EXPECT_GT(killed, kills / 3);
}

}  // namespace strata::test
