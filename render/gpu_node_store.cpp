#include "render/gpu_node_store.h"

#include <algorithm>

namespace strata {
namespace {

constexpr int kErrorFlags = 16;  ///< more than a driver keeps; a lost context would report for ever

std::uint64_t largestBlock(const GlFunctions& gl) {
  long long bytes = 0;
  gl.GetInteger64v(gl::kMaxShaderStorageBlockSize, &bytes);
  return static_cast<std::uint64_t>(std::max(bytes, 0LL));
}

}  // namespace

GpuNodeStore::GpuNodeStore(const GlFunctions& functions, std::uint64_t gpuBytes, std::uint64_t uploadBytesPerFrame)
    : gl_(functions),
      maxBytes_(gpuBytes),
      maxPageBytes_(std::min(kPageBytes, largestBlock(functions))),
      uploadBytesPerFrame_(uploadBytesPerFrame) {}

void GpuNodeStore::beginFrame(const RenderList& list) {
  ++frame_;
  uploadedBytes_ = 0;
  for (auto entry = entries_.begin(); entry != entries_.end();) entry = entry->node.expired() ? erase(entry) : ++entry;
  for (const RenderItem& item : list.items) {
    const auto found = index_.find(item.node.get());
    if (found == index_.end()) continue;
    found->second->frame = frame_;
    entries_.splice(entries_.end(), entries_, found->second);
  }
}

std::optional<GpuNode> GpuNodeStore::require(const std::shared_ptr<const NodeData>& node) {
  if (const auto found = index_.find(node.get()); found != index_.end()) return found->second->place;

  const std::uint64_t words = std::uint64_t{node->pointCount()} * static_cast<std::uint64_t>(node->loadedPlanes());
  const std::uint64_t bytes = words * 4;
  if (bytes == 0 || bytes > maxPageBytes_) return std::nullopt;
  if (uploadedBytes_ > 0 && uploadedBytes_ + bytes > uploadBytesPerFrame_) return std::nullopt;
  GpuNode place;
  place.planeStride = node->pointCount();
  if (!allocate(static_cast<std::uint32_t>(words), place)) return std::nullopt;

  GlBuffer& buffer = pages_[place.page]->buffer;
  for (int p = 0; p < node->loadedPlanes(); ++p) {
    const std::uint64_t word = place.firstWord + std::uint64_t{place.planeStride} * static_cast<std::uint64_t>(p);
    buffer.write(word * 4, node->position[p].data(), std::uint64_t{place.planeStride} * 4);
  }
  uploadedBytes_ += bytes;
  entries_.push_back({node.get(), node, place, static_cast<std::uint32_t>(words), frame_});
  index_[node.get()] = std::prev(entries_.end());
  return place;
}

/// Evicts as long as that can help.
bool GpuNodeStore::allocate(std::uint32_t words, GpuNode& place) {
  for (;;) {
    for (std::uint32_t page = 0; page < pages_.size(); ++page) {
      if (const auto first = pages_[page]->allocator.allocate(words)) {
        place.page = page;
        place.firstWord = *first;
        return true;
      }
    }
    if (addPage(words)) continue;
    if (entries_.empty() || entries_.front().frame == frame_) return false;
    erase(entries_.begin());
  }
}

/// False where the cap or the driver allows no page that holds `words`.
bool GpuNodeStore::addPage(std::uint32_t words) {
  const std::uint64_t bytes = std::min(maxPageBytes_, maxBytes_ - pageBytes_) / 4 * 4;
  if (driverIsFull_ || bytes < std::uint64_t{words} * 4) return false;
  for (int i = 0; i < kErrorFlags && gl_.GetError() != 0; ++i) {
  }
  auto page = std::make_unique<Page>(gl_, bytes);
  driverIsFull_ = gl_.GetError() != 0;
  if (driverIsFull_) return false;
  pageBytes_ += bytes;
  pages_.push_back(std::move(page));
  return true;
}

GpuNodeStore::Entries::iterator GpuNodeStore::erase(Entries::iterator entry) {
  pages_[entry->place.page]->allocator.release(entry->place.firstWord, entry->words);
  index_.erase(entry->key);
  return entries_.erase(entry);
}

}  // namespace strata
