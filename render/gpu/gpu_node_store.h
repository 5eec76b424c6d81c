#pragma once
#include <cstdint>
#include <list>
#include <memory>
#include <unordered_map>
#include <vector>

#include "core/render_list.h"
#include "render/gl/gl_objects.h"
#include "render/gl/gl_staging.h"
#include "render/gpu/node_parts.h"
#include "render/gpu/page_allocator.h"
#include "render/shaders/shader_types.h"

namespace strata {

/// Keeps nodes in GPU memory, in storage buffers ("pages") of at most kPageBytes, because a driver may not bind larger
/// ones. A node may have any length: it is split into parts at its batches. Where room is missing, the node that was
/// listed least recently is evicted.
/// Nodes are found by their address. A node that took the address of a freed one is not mistaken for it, because the
/// weak pointer of the old entry has expired.
class GpuNodeStore {
 public:
  static constexpr std::uint64_t kPageBytes = std::uint64_t{64} << 20;
  static constexpr std::uint64_t kPartBytes = kPageBytes / 4;

  /// `gpuBytes` caps the node data on the GPU, and `uploadBytesPerFrame` the uploads of one frame. `groupSize` is the
  /// number of threads of a work group, which decides how compute32.comp lays out the candidates of a batch.
  GpuNodeStore(const GlFunctions& functions, std::uint64_t gpuBytes, std::uint64_t uploadBytesPerFrame,
               std::uint32_t groupSize);

  /// Frees nodes that the host has dropped, and protects those of `list` from eviction until the next call.
  void beginFrame(const RenderList& list);
  /// Returns the node with all that is needed of it, after uploading what is missing. Null where the upload budget of
  /// this frame is used up (the first upload of a frame always passes), no memory can be freed, or a batch is longer
  /// than a page.
  const GpuNode* require(const std::shared_ptr<const NodeData>& node, const NodeNeeds& needs);

  void bindPage(std::uint32_t page) const { pages_[page]->buffer.bindStorage(STRATA_BINDING_PAGE); }
  /// The bytes uploaded since beginFrame().
  std::uint64_t uploadedBytes() const { return uploadedBytes_; }
  /// The bytes of all pages, at most the `gpuBytes` of the constructor.
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
    GpuNode gpuNode;
    std::vector<std::uint32_t> words;  ///< the length of each part
    bool classes, colours;             ///< the parts have room for them
    std::uint64_t colourKey;
    std::uint64_t frame;  ///< the last frame that listed the node
  };
  using Entries = std::list<Entry>;

  bool withinBudget(std::uint64_t bytes);
  Entries::iterator upload(const std::shared_ptr<const NodeData>& node, const NodeNeeds& needs);
  bool allocate(std::uint32_t words, NodePart& part);
  bool addPage(std::uint32_t words);
  void releaseParts(const GpuNode& gpuNode, const std::vector<std::uint32_t>& words);
  void writePart(const NodeData& node, const GpuNode& gpuNode, const NodePart& part, std::uint32_t words,
                 const NodeNeeds& needs);
  void writeColours(const NodeData& node, const NodePart& part, const NodeNeeds& needs);
  Entries::iterator erase(Entries::iterator entry);

  const GlFunctions& gl_;
  const std::uint64_t maxBytes_;
  const std::uint64_t maxPageBytes_;
  const std::uint64_t uploadBytesPerFrame_;
  const std::uint32_t groupSize_;
  std::vector<std::unique_ptr<Page>> pages_;
  Entries entries_;  ///< least recently listed first
  std::unordered_map<const NodeData*, Entries::iterator> index_;
  GlStaging staging_;
  std::uint64_t frame_ = 0;
  std::uint64_t pageBytes_ = 0;
  std::uint64_t uploadedBytes_ = 0;
  bool driverIsFull_ = false;
};

}  // namespace strata
