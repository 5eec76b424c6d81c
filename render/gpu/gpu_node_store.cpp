#include "render/gpu/gpu_node_store.h"

#include <algorithm>

#include "core/log.h"
#include "render/gpu/node_parts.h"
#include "render/picture/point_colour.h"

namespace strata {
namespace {

constexpr int kErrorFlags = 16;  ///< more than a driver keeps; a lost context would report errors for ever

}  // namespace

GpuNodeStore::GpuNodeStore(const GlFunctions& functions, std::uint64_t gpuBytes, std::uint64_t uploadBytesPerFrame,
                           std::uint32_t groupSize)
    : gl_(functions),
      maxBytes_(gpuBytes),
      maxPageBytes_(std::min(kPageBytes, largestStorageBlock(functions))),
      uploadBytesPerFrame_(uploadBytesPerFrame),
      groupSize_(groupSize),
      staging_(functions, kPartBytes) {}

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

/// True when `bytes` more may be uploaded in this frame. The first upload always passes, so that a large node gets its
/// turn.
bool GpuNodeStore::withinBudget(std::uint64_t bytes) {
  return uploadedBytes_ == 0 || uploadedBytes_ + bytes <= uploadBytesPerFrame_;
}

const GpuNode* GpuNodeStore::require(const std::shared_ptr<const NodeData>& node, const NodeNeeds& needs) {
  auto found = index_.find(node.get());
  NodeNeeds all = needs;
  if (found != index_.end()) {
    Entry& entry = *found->second;
    const bool room = (entry.classes || !needs.classes) && (entry.colours || !needs.colours);
    if (room && needs.colours && entry.colourKey != needs.colourKey) {
      const std::uint64_t bytes = std::uint64_t{node->pointCount()} * 4;
      if (!withinBudget(bytes)) return nullptr;
      for (const NodePart& part : entry.gpuNode.parts) writeColours(*node, part, needs);
      entry.colourKey = needs.colourKey;
      uploadedBytes_ += bytes;
    }
    if (room) return &entry.gpuNode;
    all.classes = all.classes || entry.classes;  // they were needed before, and may be again
  }
  std::uint64_t bytes = 0;
  for (const NodePart& part : splitNode(*node, all, std::min(kPartBytes, maxPageBytes_), groupSize_))
    bytes += partWords(part, node->loadedPlanes(), all) * 4;
  if (bytes == 0 || !withinBudget(bytes)) return nullptr;
  if (found != index_.end()) erase(found->second);
  const auto entry = upload(node, all);
  return entry == entries_.end() ? nullptr : &entry->gpuNode;
}

GpuNodeStore::Entries::iterator GpuNodeStore::upload(const std::shared_ptr<const NodeData>& node,
                                                     const NodeNeeds& needs) {
  GpuNode gpuNode;
  gpuNode.planes = node->loadedPlanes();
  findGrid(*node, gpuNode);
  std::vector<std::uint32_t> words;
  for (NodePart part : splitNode(*node, needs, std::min(kPartBytes, maxPageBytes_), groupSize_)) {
    const auto length = static_cast<std::uint32_t>(partWords(part, gpuNode.planes, needs));
    if (!allocate(length, part)) {
      releaseParts(gpuNode, words);
      return entries_.end();
    }
    layOut(part, part.firstBox, gpuNode.planes, needs);
    gpuNode.parts.push_back(part);
    words.push_back(length);
  }
  for (std::size_t i = 0; i < gpuNode.parts.size(); ++i) {
    writePart(*node, gpuNode, gpuNode.parts[i], words[i], needs);
    uploadedBytes_ += std::uint64_t{words[i]} * 4;
  }
  entries_.push_back(
      {node.get(), node, std::move(gpuNode), std::move(words), needs.classes, needs.colours, needs.colourKey, frame_});
  index_[node.get()] = std::prev(entries_.end());
  return std::prev(entries_.end());
}

void GpuNodeStore::writePart(const NodeData& node, const GpuNode& gpuNode, const NodePart& part, std::uint32_t words,
                             const NodeNeeds& needs) {
  const std::span<std::uint32_t> room = staging_.room(words);
  std::fill(room.begin(), room.end(), 0);
  fillPart(node, gpuNode, part, groupSize_, room);
  staging_.send(pages_[part.page]->buffer, std::uint64_t{part.firstBox} * 4);
  if (needs.colours) writeColours(node, part, needs);
}

void GpuNodeStore::writeColours(const NodeData& node, const NodePart& part, const NodeNeeds& needs) {
  pointColours(node, part.firstPoint, *needs.options, Precision::low10, staging_.room(part.pointCount));
  staging_.send(pages_[part.page]->buffer, std::uint64_t{part.firstColour} * 4);
}

/// Finds a range for a part. Where no page has one, it adds a page, or else evicts nodes until one fits or only nodes
/// of this frame are left.
bool GpuNodeStore::allocate(std::uint32_t words, NodePart& part) {
  for (;;) {
    for (std::uint32_t page = 0; page < pages_.size(); ++page) {
      if (const auto first = pages_[page]->allocator.allocate(words)) {
        part.page = page;
        part.firstBox = *first;
        return true;
      }
    }
    if (addPage(words)) continue;
    if (entries_.empty() || entries_.front().frame == frame_) return false;
    erase(entries_.begin());
  }
}

/// Adds a page that holds at least `words`. False where the cap or the driver does not allow it. A driver that refuses
/// a page is asked for smaller ones; once it has refused the smallest, it is not asked again.
bool GpuNodeStore::addPage(std::uint32_t words) {
  std::uint64_t bytes = std::min(maxPageBytes_, maxBytes_ - pageBytes_) / 16 * 16;
  const std::uint64_t least = std::uint64_t{words} * 4;
  while (!driverIsFull_ && bytes >= least) {
    for (int i = 0; i < kErrorFlags && gl_.GetError() != 0; ++i) {
    }
    auto page = std::make_unique<Page>(gl_, bytes);
    if (gl_.GetError() == 0) {
      pageBytes_ += bytes;
      pages_.push_back(std::move(page));
      return true;
    }
    bytes = bytes / 2 / 16 * 16;
    if (bytes >= least) continue;
    driverIsFull_ = true;
    logWarning("OpenGL: out of GPU memory at " + std::to_string(pageBytes_ >> 20) + " MiB of points (expected up to " +
               std::to_string(maxBytes_ >> 20) + " MiB); drawing with that");
  }
  return false;
}

void GpuNodeStore::releaseParts(const GpuNode& gpuNode, const std::vector<std::uint32_t>& words) {
  for (std::size_t i = 0; i < gpuNode.parts.size(); ++i)
    pages_[gpuNode.parts[i].page]->allocator.release(gpuNode.parts[i].firstBox, words[i]);
}

GpuNodeStore::Entries::iterator GpuNodeStore::erase(Entries::iterator entry) {
  releaseParts(entry->gpuNode, entry->words);
  index_.erase(entry->key);
  return entries_.erase(entry);
}

}  // namespace strata
