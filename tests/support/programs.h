#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/las_maker.h"
#include "tests/support/run_program.h"

namespace strata::test {

using Json = nlohmann::json;

/// The JSON object that `--json` prints as the last line.
inline Json lastLine(const Finished& finished) {
  const std::vector<std::string> lines = linesOf(finished.out);
  if (lines.empty()) throw std::runtime_error("nothing on stdout; stderr: " + finished.err);
  return Json::parse(lines.back());
}

inline Finished convert(const std::vector<std::string>& inputs, const std::filesystem::path& store,
                        const std::vector<std::string>& options = {}) {
  std::vector<std::string> arguments = inputs;
  arguments.insert(arguments.end(), {"-o", store.string(), "--json"});
  arguments.insert(arguments.end(), options.begin(), options.end());
  return runProgram("strata-convert", arguments);
}

/// Converts, expects that to work, and gives what `--json` said.
inline Json mustConvert(const std::vector<std::string>& inputs, const std::filesystem::path& store,
                        const std::vector<std::string>& options = {}) {
  const Finished finished = convert(inputs, store, options);
  if (finished.exitCode != 0) throw std::runtime_error("strata-convert failed: " + finished.err);
  return lastLine(finished);
}

inline Json mustInfo(const std::filesystem::path& store, bool verify = false) {
  std::vector<std::string> arguments{store.string(), "--json"};
  if (verify) arguments.push_back("--verify");
  const Finished finished = runProgram("strata-info", arguments);
  if (finished.exitCode != 0) throw std::runtime_error("strata-info failed: " + finished.err);
  return lastLine(finished);
}

inline LasFile mustExport(const std::filesystem::path& store, const std::filesystem::path& las) {
  const Finished finished = runProgram("strata-export", {store.string(), "-o", las.string(), "--force"});
  if (finished.exitCode != 0) throw std::runtime_error("strata-export failed: " + finished.err);
  return readLas(las);
}

/// What every failure looks like: exit code 1, and on stderr nothing but one line that begins with "error: ".
inline void expectFailure(const Finished& finished) {
  EXPECT_EQ(finished.exitCode, 1) << finished.err;
  const std::vector<std::string> lines = linesOf(finished.err);
  EXPECT_EQ(lines.size(), 1u) << finished.err;
  EXPECT_EQ(finished.err.rfind("error: ", 0), 0u) << finished.err;
  EXPECT_TRUE(finished.err.size() < 600 && finished.err.ends_with('\n')) << finished.err;
}

/// A conversion that failed and left nothing under the final name.
inline void expectRefused(const Finished& finished, const std::filesystem::path& store) {
  expectFailure(finished);
  EXPECT_FALSE(std::filesystem::exists(store)) << store << " was left behind";
}

/// Wrong usage: exit code 2 and a line that says so.
inline void expectUsageError(const Finished& finished) {
  EXPECT_EQ(finished.exitCode, 2) << finished.err;
  EXPECT_EQ(finished.err.rfind("error: ", 0), 0u) << finished.err;
}

inline bool mentions(const Finished& finished, const std::string& words) {
  return finished.err.find(words) != std::string::npos;
}

inline bool sameStores(const std::filesystem::path& a, const std::filesystem::path& b) {
  for (const char* name : {"hierarchy.bin", "points.bin", "store.json"})
    if (readWhole(a / name) != readWhole(b / name)) return false;
  return true;
}

/// A regular grid of n x n x 1 points, one LAS unit (1 cm) apart times `step`.
inline std::vector<std::array<std::int32_t, 3>> gridPoints(int n, int step = 10) {
  std::vector<std::array<std::int32_t, 3>> points;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) points.push_back({x * step, y * step, (x * 7 + y * 3) % 50});
  return points;
}

}  // namespace strata::test
