#include "render/gpu/page_allocator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace strata {
namespace {

struct Range {
  std::uint32_t first, words;
};

TEST(PageAllocator, GivesRangesThatNeverOverlapAndJoinsThemAgain) {
  constexpr std::uint32_t kWords = 5000;
  std::mt19937 random(1);
  PageAllocator page(kWords);
  std::vector<bool> taken(kWords, false);
  std::vector<Range> held;
  for (int step = 0; step < 20000; ++step) {
    if (held.empty() || random() % 2 == 0) {
      const std::uint32_t words = 1 + static_cast<std::uint32_t>(random()) % 300;
      const auto first = page.allocate(words);
      if (!first) {
        EXPECT_LT(page.longestFree(), words);
        continue;
      }
      ASSERT_LE(*first + words, kWords);
      for (std::uint32_t i = *first; i < *first + words; ++i) {
        ASSERT_FALSE(taken[i]);
        taken[i] = true;
      }
      held.push_back({*first, words});
    } else {
      std::swap(held[random() % held.size()], held.back());
      const Range range = held.back();
      held.pop_back();
      for (std::uint32_t i = range.first; i < range.first + range.words; ++i) taken[i] = false;
      page.release(range.first, range.words);
    }
    EXPECT_EQ(page.freeWords(), static_cast<std::uint32_t>(std::count(taken.begin(), taken.end(), false)));
  }
  for (const Range& range : held) page.release(range.first, range.words);
  EXPECT_EQ(page.longestFree(), kWords);
}

TEST(PageAllocator, RefusesWhatDoesNotFit) {
  PageAllocator page(100);
  EXPECT_FALSE(page.allocate(101));
  EXPECT_EQ(page.allocate(100), 0u);
  EXPECT_FALSE(page.allocate(1));
  EXPECT_FALSE(PageAllocator(0).allocate(1));
}

}  // namespace
}  // namespace strata
