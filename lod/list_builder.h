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

/// A render list and its holds on the cache, which its last user gives back with NodeCache::unpin().
struct PinnedList {
  RenderList list;
  std::vector<NodeCache::Pin> pins;
};

/// The result of an LOD pass: a list to draw and requests to load.
struct LodOutput {
  PinnedList pinned;
  std::vector<LoadRequest> requests;
};

/// Splits a selection into a render list of the nodes that are resident and requests for the others. LOD thread only;
/// keeps its memory for the next pass.
class ListBuilder {
 public:
  struct Result {
    std::uint32_t resident = 0;      ///< wanted nodes that are in memory
    std::uint32_t absent = 0;        ///< wanted nodes that are not
    std::uint32_t overCapacity = 0;  ///< wanted nodes that the cache is too small to hold beside more urgent ones
    std::uint32_t requests = 0;      ///< requests for this view, without those that lookAhead() adds
    std::uint32_t waiting = 0;       ///< nodes that have failed and may not be tried again before `retryAt`
    FailedNodes::Clock::time_point retryAt = FailedNodes::Clock::time_point::max();
  };

  /// The arguments have to outlive the builder.
  ListBuilder(const Store& store, std::span<const std::uint32_t> parents, Precision leastPrecision, NodeCache& cache);

  /// Fills `out.pinned`, which must be empty, and replaces `out.requests`. A node is drawn when it and all its
  /// ancestors are resident, with as many points as `fade`, which has begun, allows. Nodes out of tries, and everything
  /// below them, are not asked for again.
  Result build(const Selection& selection, const SelectionOptions& options, const FailedNodes::ByNode& failed,
               Fade& fade, LodOutput& out);

  /// After build(): adds requests for what the selection of a view to come wants beyond the last one, as far as the
  /// cache has room for both.
  void lookAhead(const Selection& selection, const FailedNodes::ByNode& failed, std::vector<LoadRequest>& requests);

  /// Indices of the nodes in the last list, ascending.
  std::span<const std::uint32_t> drawn() const { return drawn_; }

 private:
  /// The decision of a pass about a wanted node.
  enum class Fate : std::uint32_t {
    drawn,
    missing,  ///< it or a node above it is not resident
    givenUp,  ///< it or a node above it is out of tries
  };
  /// The fate of a node and the pass that decided it, in 4 bytes, for there is one for each node of the store.
  class Mark {
   public:
    Mark() = default;
    Mark(std::uint32_t pass, Fate fate) : bits_(pass << 2 | static_cast<std::uint32_t>(fate)) {}
    bool isOf(std::uint32_t pass) const { return bits_ >> 2 == pass; }
    Fate fate() const { return static_cast<Fate>(bits_ & 3); }

   private:
    std::uint32_t bits_ = 0;
  };
  /// A wanted node, and its state in the cache.
  struct WantedNode {
    const SelectedNode& selected;
    const StreamedNode* present;          ///< null when it is not resident
    const FailedNodes::Failure* failure;  ///< null when it has not failed
    Fate parentFate;
  };

  std::uint32_t takeWhatFits(const Selection& selection);
  void learnShare();
  WantedNode wantedNode(std::size_t i, const FailedNodes::ByNode& failed) const;
  static Fate fateOf(const WantedNode& node);
  std::optional<LoadRequest> requestFor(const SelectedNode& wanted, const StreamedNode* present) const;
  void ask(const WantedNode& node, LoadRequest request, Result& result, std::vector<LoadRequest>& requests) const;
  void draw(std::size_t i, bool wasMissing, Fade& fade, RenderList& list);
  std::uint32_t bytesNeeded(const NodeRecord& record, const StreamedNode& present, Precision precision) const;
  std::uint32_t bytesAtMost(const NodeRecord& record, Precision precision) const;

  // Constant after construction.
  const Store& store_;
  const std::span<const std::uint32_t> parents_;
  const Precision leastPrecision_;
  const std::uint64_t bytesAPoint_;  ///< bound on the memory of a point
  NodeCache& cache_;

  // Used by the LOD thread.
  std::optional<ColourMode> shown_;     ///< Shown::colour
  bool normals_ = false;                ///< normals are shown and the store has them
  double share_ = 1.0;                  ///< see learnShare()
  std::uint32_t pass_ = 0;              ///< counts from 1
  FailedNodes::Clock::time_point now_;  ///< when the pass began
  std::vector<Mark> marks_;             ///< by node; of the last pass that wanted it
  std::vector<SelectedNode> wanted_;    ///< those that fit the cache, by ascending index
  std::vector<std::uint32_t> indices_;  ///< the nodes of wanted_
  std::vector<NodeCache::Data> found_;  ///< by position in wanted_; null where the node is not resident
  std::vector<std::uint32_t> drawn_;    ///< the nodes of the list
  std::uint64_t wantedBytes_ = 0;       ///< bound on the memory of all wanted_
};

}  // namespace strata
