#include "render/gpu/page_allocator.h"

#include <algorithm>

namespace strata {

PageAllocator::PageAllocator(std::uint32_t words) : freeWords_(words) {
  if (words > 0) free_[0] = words;
}

std::optional<std::uint32_t> PageAllocator::allocate(std::uint32_t words) {
  for (auto range = free_.begin(); range != free_.end(); ++range) {
    const auto [first, length] = *range;
    if (length < words) continue;
    free_.erase(range);
    if (length > words) free_[first + words] = length - words;
    freeWords_ -= words;
    return first;
  }
  return std::nullopt;
}

void PageAllocator::release(std::uint32_t firstWord, std::uint32_t words) {
  freeWords_ += words;
  auto after = free_.lower_bound(firstWord);
  if (after != free_.end() && after->first == firstWord + words) {
    words += after->second;
    after = free_.erase(after);
  }
  if (after != free_.begin()) {
    const auto before = std::prev(after);
    if (before->first + before->second == firstWord) {
      before->second += words;
      return;
    }
  }
  free_[firstWord] = words;
}

std::uint32_t PageAllocator::longestFree() const {
  std::uint32_t longest = 0;
  for (const auto& [first, length] : free_) longest = std::max(longest, length);
  return longest;
}

}  // namespace strata
