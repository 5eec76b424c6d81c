#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/test_data.h"

namespace strata::test {

/// One line of EXPECTED.tsv, joined with MANIFEST.tsv.
struct RealScan {
  std::string file;           ///< below dataFolder(); empty stands for "the real scans are absent"
  std::string format;         ///< as the manifest words it
  std::uint64_t points = 0;   ///< that a reader gets, those that are not finite included
  std::string min, max;       ///< "x,y,z"
  std::string recordsSha256;  ///< of the LAS records in the file's order; empty where it is no LAS

  std::filesystem::path path() const { return dataFolder() / file; }
  std::string ending() const { return std::filesystem::path(file).extension().string(); }
  bool isLas() const { return ending() == ".las" || ending() == ".laz"; }
  bool isTile() const { return file.find("red-rocks-tiles/") != std::string::npos; }
  /// LAS point data format out of "LAZ 1.2 PDRF3 rec34 [...]", or -1.
  int pointFormat() const {
    const std::size_t at = format.find("PDRF");
    return at == std::string::npos ? -1 : std::stoi(format.substr(at + 4));
  }
};

/// gtest prints parameters; the file's name says it all.
inline void PrintTo(const RealScan& scan, std::ostream* out) { *out << scan.file; }

/// `las/basic/simple.las` as a test's name.
inline std::string testName(const testing::TestParamInfo<RealScan>& info) {
  std::string name = info.param.file.empty() ? "absent" : info.param.file;
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
}

namespace detail {
inline std::vector<std::vector<std::string>> readTable(const std::filesystem::path& file) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> cells;
    std::istringstream words(line);
    for (std::string cell; std::getline(words, cell, '\t');) cells.push_back(cell);
    cells.resize(std::max<std::size_t>(cells.size(), 10));
    rows.push_back(cells);
  }
  if (!rows.empty()) rows.erase(rows.begin());  // the titles
  return rows;
}
}  // namespace detail

/// Every file of the manifest; `points` is 0 and `min` empty for those that EXPECTED.tsv does not list.
inline std::vector<RealScan> allScans() {
  std::vector<RealScan> scans;
  if (dataFolder().empty()) return scans;
  std::map<std::string, std::vector<std::string>> expected;
  for (const auto& row : detail::readTable(dataFolder() / "EXPECTED.tsv")) expected[row[0]] = row;
  for (const auto& row : detail::readTable(dataFolder() / "MANIFEST.tsv")) {
    RealScan scan{row[0], row[4], 0, {}, {}, {}};
    if (const auto found = expected.find(scan.file); found != expected.end()) {
      scan.points = std::stoull(found->second[1]);
      scan.min = found->second[2];
      scan.max = found->second[3];
      scan.recordsSha256 = found->second[6] == "-" ? "" : found->second[6];
    }
    scans.push_back(scan);
  }
  return scans;
}

/// Those that `keep` wants, or the one that stands for their absence, so that the test can say why it skips.
template <class Keep>
std::vector<RealScan> scansWhere(Keep keep) {
  std::vector<RealScan> scans = allScans();
  if (scans.empty()) return {RealScan{}};
  std::erase_if(scans, [&keep](const RealScan& scan) { return !keep(scan); });
  return scans;
}

/// "x,y,z" with the digits that the table prints: 6 decimals, or 6 significant digits.
inline std::vector<double> triple(const std::string& text) {
  std::string plain = text;
  std::erase_if(plain, [](char c) { return c == '[' || c == ']'; });
  std::vector<double> values;
  std::istringstream words(plain);
  for (std::string word; std::getline(words, word, ',');) values.push_back(std::stod(word));
  return values;
}

/// Half a unit of the sixth significant digit, and not less than half of the sixth decimal.
inline double printedTolerance(double value) {
  if (value == 0.0) return 1e-6;
  return std::max(1e-6, 0.51 * std::pow(10.0, std::floor(std::log10(std::abs(value))) - 5.0));
}

}  // namespace strata::test
