#include "render/progressive/pool_manager.h"

#include <algorithm>
#include <tuple>

namespace strata {

PoolManager::PoolManager(std::uint32_t size) : size_(size), free_(size), limit_(size), lowestFree_(blocks_.end()) {
  if (size == 0) return;
  blocks_.push_back({0, size});
  lowestFree_ = blocks_.begin();
}

void PoolManager::beginFrame() {
  ++frame_;
  victims_.clear();
  victimsKnown_ = false;
  for (PoolBlock& block : blocks_)
    if (block.importance > 0) --block.importance;
}

void PoolManager::shown(Block block) {
  if (block->shown == frame_) return;
  block->shown = frame_;
  block->importance = std::min(block->importance + 2, kMostImportance);  // one of them makes up for beginFrame()
}

PoolManager::Block PoolManager::firstFit(std::uint32_t size) {
  bool passed = false;  // a free block that is too small
  for (Block block = lowestFree_; block != blocks_.end(); ++block) {
    if (block->first >= limit_) return blocks_.end();
    if (!block->free) continue;
    if (!passed) lowestFree_ = block;
    passed = true;
    if (std::min(block->size, limit_ - block->first) >= size) return block;
  }
  if (!passed) lowestFree_ = blocks_.end();
  return blocks_.end();
}

void PoolManager::findVictims() {
  victimsKnown_ = true;
  for (Block block = blocks_.begin(); block != blocks_.end() && block->first < limit_; ++block)
    if (!block->free && block->shown != frame_) victims_.push_back(block);
  std::sort(victims_.begin(), victims_.end(), [](const Block& a, const Block& b) {
    return std::tie(a->importance, a->shown, a->first) > std::tie(b->importance, b->shown, b->first);
  });
}

std::optional<PoolManager::Block> PoolManager::allocate(std::uint32_t size, std::uint32_t owner,
                                                        const std::function<void(std::uint32_t)>& freed) {
  Block block = firstFit(size);
  if (block == blocks_.end()) {
    if (!victimsKnown_) findVictims();
    std::uint64_t room = 0;
    for (Block b = blocks_.begin(); b != blocks_.end() && b->first < limit_ && room < size; ++b)
      if (b->free || b->shown != frame_) room += std::min(b->size, limit_ - b->first);
    if (room < size) return std::nullopt;
  }
  while (block == blocks_.end()) {
    if (victims_.empty()) return std::nullopt;
    const Block victim = victims_.back();
    victims_.pop_back();
    freed(victim->owner);
    release(victim);
    block = firstFit(size);
  }
  if (block->size > size) {
    const Block rest = blocks_.insert(std::next(block), {block->first + size, block->size - size});
    if (lowestFree_ == block) lowestFree_ = rest;
  }
  *block = {block->first, size, false, owner, 1, frame_};
  free_ -= size;
  return block;
}

void PoolManager::release(Block block) {
  free_ += block->size;
  if (victimsKnown_) std::erase(victims_, block);
  *block = {block->first, block->size};
  const auto join = [this](Block into, Block next) {
    into->size += next->size;
    if (lowestFree_ == next) lowestFree_ = into;
    blocks_.erase(next);
  };
  if (const Block next = std::next(block); next != blocks_.end() && next->free) join(block, next);
  if (block != blocks_.begin())
    if (const Block before = std::prev(block); before->free) {
      join(before, block);
      block = before;
    }
  if (lowestFree_ == blocks_.end() || block->first < lowestFree_->first) lowestFree_ = block;
}

}  // namespace strata
