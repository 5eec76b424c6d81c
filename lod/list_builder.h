#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/render_list.h"
#include "io/store/store.h"
#include "lod/fade.h"
#include "lod/failed_nodes.h"
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
  struct Result {
    std::uint32_t resident = 0;      ///< wanted nodes that are in memory
    std::uint32_t absent = 0;        ///< wanted nodes that are not
    std::uint32_t overCapacity = 0;  ///< wanted, but the cache is too small to ever hold them beside the more urgent
    std::uint32_t requests = 0;      ///< for this view, without what lookAhead() adds
    std::uint32_t waiting = 0;       ///< failed, and not yet to be tried again ...
    FailedNodes::Clock::time_point retryAt = FailedNodes::Clock::time_point::max();  ///< ... before this
  };

  /// The arguments have to outlive the builder.
  ListBuilder(const Store& store, std::span<const std::uint32_t> parents, Precision leastPrecision, NodeCache& cache);

  /// Fills `out.list.items` and `out.pins`, which must be empty, and replaces `requests`. A node is drawn when it and
  /// all its ancestors are resident, with as many points as `fade`, which has begun, allows. Nodes out of tries, and
  /// all below them, are not asked for again.
  Result build(const Selection& selection, const SelectionOptions& options, const FailedNodes::ByNode& failed,
               Fade& fade, PinnedList& out, std::vector<LoadRequest>& requests);

  /// After build(): adds requests for what another selection, of a view to come, wants beyond it, as far as the cache
  /// has room for both.
  void lookAhead(const Selection& selection, const FailedNodes::ByNode& failed, std::vector<LoadRequest>& requests);

  /// Indices of the nodes in the last list, ascending.
  std::span<const std::uint32_t> drawn() const { return drawn_; }

 private:
  /// Keeps the most urgent nodes that fit the cache together, in `wanted_` by ascending index.
  std::uint32_t takeWhatFits(const Selection& selection);
  /// For what is lacking of a node; none where nothing is. `present` is the node as it is, or null.
  std::optional<LoadRequest> requestFor(const SelectedNode& wanted, const StreamedNode* present) const;
  /// Leading bytes of the payload that the view needs.
  std::uint32_t bytesNeeded(const NodeRecord& record, const StreamedNode& present, Precision precision) const;
  std::uint32_t bytesAtMost(const NodeRecord& record, Precision precision) const;
  void learnShare();

  const Store& store_;
  const std::span<const std::uint32_t> parents_;
  const Precision leastPrecision_;
  const std::uint64_t bytesAPoint_;  ///< of memory, at most
  NodeCache& cache_;

  std::optional<ColourMode> shown_;  ///< SelectionOptions::shown
  bool normals_ = false;             ///< ... and normals, in a store that has them
  double share_ = 1.0;               ///< of bytesAtMost() that nodes needed at most, of those that are wanted and here

  enum Mark : std::uint32_t { kDrawn, kBlocked, kMissing, kMarks };
  std::uint32_t pass_ = 0;
  std::vector<std::uint32_t> marks_;  ///< by node: pass_ * kMarks + Mark, of the pass that set it
  std::vector<SelectedNode> wanted_;
  std::vector<std::uint32_t> indices_;  ///< of wanted_
  std::vector<NodeCache::Data> found_;  ///< by position in wanted_
  std::vector<std::uint32_t> drawn_;    ///< of the list
  std::uint64_t wantedBytes_ = 0;       ///< bound on the memory of all wanted_
};

}  // namespace strata
