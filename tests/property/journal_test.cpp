#include "converter/journal/journal.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/las_maker.h"
#include "tests/support/run_program.h"

namespace strata {
namespace {

std::vector<std::vector<std::byte>> payloadsOf(const Journal& journal) {
  std::vector<std::vector<std::byte>> payloads;
  for (const Journal::FoundRecord& record : journal.found()) payloads.push_back(journal.payload(record));
  return payloads;
}

/// Ten records of different sizes; returns their payloads.
std::vector<std::vector<std::byte>> writeTen(const std::string& path) {
  Journal journal(path);
  std::vector<std::vector<std::byte>> payloads;
  for (unsigned i = 0; i < 10; ++i) {
    payloads.emplace_back(i * 37, static_cast<std::byte>(i));
    journal.append(RecordKind::runs, payloads.back());
  }
  return payloads;
}

TEST(Journal, CutOffAnywhereGivesTheWholeRecordsBefore) {
  const test::TempFolder folder;
  const std::string path = (folder / "journal").string();
  const auto payloads = writeTen(path);
  const std::string bytes = test::readWhole(path);
  for (std::size_t keep = 0; keep < bytes.size(); keep += 7) {
    test::writeBytes(path, bytes.substr(0, keep));
    const auto found = payloadsOf(Journal(path));
    ASSERT_LE(found.size(), payloads.size());
    EXPECT_TRUE(std::equal(found.begin(), found.end(), payloads.begin())) << keep;
    EXPECT_LT(found.size(), payloads.size()) << keep;
  }
}

TEST(Journal, AFlippedByteIsFoundAndEndsIt) {
  const test::TempFolder folder;
  const std::string path = (folder / "journal").string();
  const auto payloads = writeTen(path);
  const std::string bytes = test::readWhole(path);
  for (std::size_t at = 8; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x20);
    test::writeBytes(path, damaged);
    const auto found = payloadsOf(Journal(path));
    ASSERT_LT(found.size(), payloads.size()) << at;
    EXPECT_TRUE(std::equal(found.begin(), found.end(), payloads.begin())) << at;
  }
}

TEST(Journal, GoesOnBehindTheLastSoundRecord) {
  const test::TempFolder folder;
  const std::string path = (folder / "journal").string();
  auto payloads = writeTen(path);
  test::writeBytes(path, test::readWhole(path) + "half a record");
  {
    Journal journal(path);
    payloads.emplace_back(5, std::byte{9});
    journal.append(RecordKind::chunk, payloads.back());
  }
  EXPECT_EQ(payloadsOf(Journal(path)), payloads);
}

TEST(Journal, RewoundForgetsWhatCameAfter) {
  const test::TempFolder folder;
  const std::string path = (folder / "journal").string();
  Journal journal(path);
  const std::vector<std::byte> payload(100, std::byte{1});
  journal.append(RecordKind::options, payload);
  const std::uint64_t end = journal.bytes();
  journal.append(RecordKind::runs, payload);
  journal.rewind(end);
  EXPECT_EQ(payloadsOf(Journal(path)).size(), 1u);
}

}  // namespace
}  // namespace strata
