#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/render_list.h"
#include "io/store.h"
#include "lod/load_queue.h"
#include "lod/node_cache.h"
#include "lod/selection.h"

namespace strata {

/// A render list with its holds on the cache. Whoever has it last gives them back.
struct PinnedList {
  RenderList list;
  std::vector<NodeCache::Pin> pins;
};

/// Splits a selection into what is resident (a render list) and what is not (requests). LOD thread only; keeps its
/// scratch memory for the next pass.
class ListBuilder {
 public:
  using Attempts = std::unordered_map<std::uint32_t, int>;

  struct Result {
    std::uint32_t resident = 0;      ///< wanted nodes that are in memory
    std::uint32_t absent = 0;        ///< wanted nodes that are not
    std::uint32_t overCapacity = 0;  ///< wanted, but the cache is too small to ever hold them beside the more urgent
  };

  /// The arguments have to outlive the builder.
  ListBuilder(const Store& store, std::span<const std::uint32_t> parents, NodeCache& cache);

  /// Fills `out.list.items` and `out.pins`, which must be empty, and replaces `requests`. A node is drawn when it and
  /// all its ancestors are resident. Nodes out of tries, and all below them, are not asked for again.
  Result build(const Selection& selection, const Attempts& attempts, PinnedList& out,
               std::vector<LoadRequest>& requests);

 private:
  /// Keeps the most urgent nodes that fit the cache together, in `wanted_` by ascending index.
  std::uint32_t takeWhatFits(const Selection& selection);
  void request(const SelectedNode& wanted, bool resident, const Attempts& attempts,
               std::vector<LoadRequest>& requests) const;

  const Store& store_;
  const std::span<const std::uint32_t> parents_;
  NodeCache& cache_;

  enum Mark : std::uint32_t { kDrawn = 0, kBlocked = 1 };
  std::uint32_t pass_ = 0;
  std::vector<std::uint32_t> marks_;  ///< by node: pass_ * 2 + Mark, of the pass that set it
  std::vector<SelectedNode> wanted_;
  std::vector<std::uint32_t> indices_;  ///< of wanted_
  std::vector<NodeCache::Data> found_;  ///< by position in wanted_
  std::uint64_t wantedBytes_ = 0;       ///< bound on the memory of all wanted_
};

}  // namespace strata
