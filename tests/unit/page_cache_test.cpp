#include "viewer/bench/page_cache.h"

#include <gtest/gtest.h>
#include <sys/vfs.h>

#include <fstream>

#include "core/error.h"
#include "tests/support/test_data.h"

namespace strata {
namespace {

constexpr std::size_t kBytes = 8 << 20;

/// A file system that lives in memory drops nothing.
bool isOnADisk(const std::string& path) {
  struct statfs system {};
  constexpr long kTmpfs = 0x01021994, kRamfs = 0x858458f6;
  return statfs(path.c_str(), &system) == 0 && system.f_type != kTmpfs && system.f_type != kRamfs;
}

void readWholly(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes(kBytes, 0);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  ASSERT_TRUE(in);
}

TEST(PageCache, AFileThatWasJustWrittenIsDroppedWhollyAndComesBackByReading) {
  const test::TempFolder folder;
  const std::string path = (folder / "points.bin").string();
  std::ofstream(path, std::ios::binary) << std::string(kBytes, 'x');  // its pages are dirty
  if (!isOnADisk(path)) GTEST_SKIP() << "the temporary folder is in memory";
  EXPECT_GT(shareInPageCache(path), 0.9);
  for (int time = 0; time < 3; ++time) {
    EXPECT_LT(dropFromPageCache(path), 0.01);
    EXPECT_LT(shareInPageCache(path), 0.01);
    readWholly(path);
    EXPECT_GT(shareInPageCache(path), 0.9);
  }
}

TEST(PageCache, AnEmptyFileHoldsNothingAndAMissingOneIsAnError) {
  const test::TempFolder folder;
  const std::string path = (folder / "empty").string();
  std::ofstream(path).flush();
  EXPECT_EQ(shareInPageCache(path), 0.0);
  EXPECT_EQ(dropFromPageCache(path), 0.0);
  EXPECT_THROW(shareInPageCache((folder / "none").string()), Error);
  EXPECT_THROW(dropFromPageCache((folder / "none").string()), Error);
}

}  // namespace
}  // namespace strata
