#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/paths.h"

namespace strata::test {

/// The folder of the real scans, with MANIFEST.tsv and EXPECTED.tsv; empty where they are absent.
inline std::filesystem::path dataFolder() {
  if (const char* named = std::getenv("STRATA_TEST_DATA")) return named;
  const std::filesystem::path beside = sourceFolder() / ".." / "shared" / "data";
  return std::filesystem::exists(beside / "MANIFEST.tsv") ? beside : std::filesystem::path();
}

/// A new, empty folder, which is removed with this object.
class TempFolder {
 public:
  TempFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "strata-test-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
    path_ = pattern;
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace strata::test

/// Skips the test where the real scans are absent.
#define STRATA_REQUIRE_DATA()                                                                \
  do {                                                                                       \
    if (strata::test::dataFolder().empty())                                                  \
      GTEST_SKIP() << "the real scans (../shared/data) are not there; set STRATA_TEST_DATA"; \
  } while (false)
