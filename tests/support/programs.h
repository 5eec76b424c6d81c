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

/// The JSON object that a program prints as its last line with `--json`. Throws where it printed nothing.
inline Json lastLine(const Finished& finished) {
  const std::vector<std::string> lines = linesOf(finished.out);
  if (lines.empty()) throw std::runtime_error("nothing on stdout; stderr: " + finished.err);
  return Json::parse(lines.back());
}

/// Runs strata-convert with `--json`.
inline Finished convert(const std::vector<std::string>& inputs, const std::filesystem::path& store,
                        const std::vector<std::string>& options = {}) {
  std::vector<std::string> arguments = inputs;
  arguments.insert(arguments.end(), {"-o", store.string(), "--json"});
  arguments.insert(arguments.end(), options.begin(), options.end());
  return runProgram("strata-convert", arguments);
}

/// Converts and returns what `--json` printed. Throws where the conversion fails.
inline Json mustConvert(const std::vector<std::string>& inputs, const std::filesystem::path& store,
                        const std::vector<std::string>& options = {}) {
  const Finished finished = convert(inputs, store, options);
  if (finished.exitCode != 0) throw std::runtime_error("strata-convert failed: " + finished.err);
  return lastLine(finished);
}

/// What strata-info prints with `--json`. Throws where it fails.
inline Json mustInfo(const std::filesystem::path& store, bool verify = false) {
  std::vector<std::string> arguments{store.string(), "--json"};
  if (verify) arguments.push_back("--verify");
  const Finished finished = runProgram("strata-info", arguments);
  if (finished.exitCode != 0) throw std::runtime_error("strata-info failed: " + finished.err);
  return lastLine(finished);
}

/// Exports the store to the file `las` and reads that. Throws where either fails.
inline LasFile mustExport(const std::filesystem::path& store, const std::filesystem::path& las) {
  const Finished finished = runProgram("strata-export", {store.string(), "-o", las.string(), "--force"});
  if (finished.exitCode != 0) throw std::runtime_error("strata-export failed: " + finished.err);
  return readLas(las);
}

/// Expects what every failure must look like: exit code 1, and on stderr only one line, which begins with "error: ".
inline void expectFailure(const Finished& finished) {
  EXPECT_EQ(finished.exitCode, 1) << finished.err;
  const std::vector<std::string> lines = linesOf(finished.err);
  EXPECT_EQ(lines.size(), 1u) << finished.err;
  EXPECT_EQ(finished.err.rfind("error: ", 0), 0u) << finished.err;
  EXPECT_TRUE(finished.err.size() < 600 && finished.err.ends_with('\n')) << finished.err;
}

/// Expects that a conversion failed and left nothing under the store's name.
inline void expectRefused(const Finished& finished, const std::filesystem::path& store) {
  expectFailure(finished);
  EXPECT_FALSE(std::filesystem::exists(store)) << store << " was left behind";
}

/// Expects exit code 2, for wrong usage, and a line that begins with "error: ".
inline void expectUsageError(const Finished& finished) {
  EXPECT_EQ(finished.exitCode, 2) << finished.err;
  EXPECT_EQ(finished.err.rfind("error: ", 0), 0u) << finished.err;
}

/// True when stderr contains `words`.
inline bool mentions(const Finished& finished, const std::string& words) {
  return finished.err.find(words) != std::string::npos;
}

/// True when the two stores are equal, byte for byte.
inline bool sameStores(const std::filesystem::path& a, const std::filesystem::path& b) {
  for (const char* name : {"hierarchy.bin", "points.bin", "store.json"})
    if (readWhole(a / name) != readWhole(b / name)) return false;
  return true;
}

/// A regular grid of n x n points, `step` LAS units apart, whose heights vary by less than 50 units.
inline std::vector<std::array<std::int32_t, 3>> gridPoints(int n, int step = 10) {
  std::vector<std::array<std::int32_t, 3>> points;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) points.push_back({x * step, y * step, (x * 7 + y * 3) % 50});
  return points;
}

}  // namespace strata::test
