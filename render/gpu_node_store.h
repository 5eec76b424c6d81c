#pragma once
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/render_list.h"
#include "render/gl_objects.h"
#include "render/page_allocator.h"
#include "render/shaders/shader_types.h"

namespace strata {

/// Where a node's position planes lie: plane p of point i is word firstWord + p * planeStride + i of the page.
struct GpuNode {
  std::uint32_t page = 0;
  std::uint32_t firstWord = 0;
  std::uint32_t planeStride = 0;
};

/// Position planes of nodes in storage buffers of at most kPageBytes (a driver may allow no larger block to be bound),
/// the least recently listed node evicted first. A node is known by its shared pointer: one that was freed never
/// stands for another that took its address, because the entry's weak pointer has expired then.
class GpuNodeStore {
 public:
  static constexpr std::uint64_t kPageBytes = std::uint64_t{64} << 20;

  GpuNodeStore(const GlFunctions& functions, std::uint64_t gpuBytes, std::uint64_t uploadBytesPerFrame);

  /// Frees nodes that are gone from the host and protects those of `list` from eviction.
  void beginFrame(const RenderList& list);
  /// Uploads the node unless it is there. None where this frame's upload budget is used up (the first upload of a
  /// frame always passes), no memory can be freed, or the node's planes are longer than a page.
  std::optional<GpuNode> require(const std::shared_ptr<const NodeData>& node);

  void bindPage(std::uint32_t page) const { pages_[page]->buffer.bindStorage(STRATA_BINDING_PAGE); }
  /// By this frame.
  std::uint64_t uploadedBytes() const { return uploadedBytes_; }
  /// Of all pages; at most the `gpuBytes` of the constructor.
  std::uint64_t gpuBytes() const { return pageBytes_; }

 private:
  struct Page {
    Page(const GlFunctions& functions, std::uint64_t bytes)
        : buffer(functions, bytes, gl::kStaticDraw), allocator(static_cast<std::uint32_t>(bytes / 4)) {}
    GlBuffer buffer;
    PageAllocator allocator;
  };
  struct Entry {
    const NodeData* key;
    std::weak_ptr<const NodeData> node;
    GpuNode place;
    std::uint32_t words;
    std::uint64_t frame;  ///< the last one that listed it
  };
  using Entries = std::list<Entry>;

  bool allocate(std::uint32_t words, GpuNode& place);
  bool addPage(std::uint32_t words);
  Entries::iterator erase(Entries::iterator entry);

  const GlFunctions& gl_;
  const std::uint64_t maxBytes_;
  const std::uint64_t maxPageBytes_;
  const std::uint64_t uploadBytesPerFrame_;
  std::vector<std::unique_ptr<Page>> pages_;
  Entries entries_;  ///< least recently listed first
  std::unordered_map<const NodeData*, Entries::iterator> index_;
  std::uint64_t frame_ = 0;
  std::uint64_t pageBytes_ = 0;
  std::uint64_t uploadedBytes_ = 0;
  bool driverIsFull_ = false;
};

}  // namespace strata
