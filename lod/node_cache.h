#pragma once
#include <cstdint>
#include <list>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/mutex.h"
#include "lod/streamed_node.h"

namespace strata {

/// Counts since construction, except the last four, which describe the cache as it is now.
struct NodeCacheStats {
  std::uint64_t inserted = 0;
  std::uint64_t replaced = 0;  ///< nodes that came again with more planes
  std::uint64_t evictions = 0;
  std::uint64_t refusals = 0;       ///< nodes that found no room beside those that may not be evicted
  std::uint64_t duplicates = 0;     ///< nodes turned away because an equal or richer version was there already
  std::uint64_t residentBytes = 0;  ///< bytes of everything held, including replaced versions that are still drawn
  std::uint64_t peakBytes = 0;      ///< the most that residentBytes ever was
  std::uint64_t pinnedBytes = 0;    ///< bytes that may not be evicted: pinned nodes and the nodes above them
  std::uint32_t residentNodes = 0;
};

/// The decoded nodes in host memory. A node that needs room evicts those that were wanted least recently (insert(),
/// evictUntil(); Kanzok 2015, 3.2.1, item 5). At every moment:
///   - residentBytes <= capacityBytes
///   - a pinned node (one that a render list holds) is resident
///   - a node is not evicted while a child of it is resident, so every drawn node's parent can be drawn
/// A node may come before its parent does. What does not fit is refused and counted.
/// Every member may be called by any thread; none does I/O or frees node memory under the lock.
class NodeCache {
 public:
  /// A resident node, as readers see it.
  using Data = std::shared_ptr<const StreamedNode>;
  /// A node that the cache no longer holds. Its memory may be used again if nobody else holds it either.
  using Released = std::shared_ptr<StreamedNode>;

  /// A hold on one node's data, taken by pin() and given back by unpin().
  struct Pin {
    std::uint32_t node = 0;
    const StreamedNode* data = nullptr;
  };

  enum class Insertion : std::uint8_t { inserted, replaced, refused, duplicate };

  /// `parents` (index of the parent by node index) has to outlive the cache.
  NodeCache(std::uint64_t capacityBytes, std::span<const std::uint32_t> parents);

  /// Takes a node in as the most recently wanted, replaces a poorer version of it, and evicts others until there is
  /// room. Appends to `out` what the cache no longer holds, which is `data` itself when it was not taken.
  Insertion insert(std::uint32_t node, std::shared_ptr<StreamedNode> data, std::vector<Released>& out);

  /// Pins the resident nodes among `nodes`, which ascend, and marks them as just wanted. Parents are marked after their
  /// children, so that they are evicted later. `found` is replaced by one entry per node, null for a node that is not
  /// resident; `pins` gets one pin per resident node.
  void pin(std::span<const std::uint32_t> nodes, std::vector<Data>& found, std::vector<Pin>& pins);
  /// Appends to `out` replaced nodes that are no longer pinned.
  void unpin(std::span<const Pin> pins, std::vector<Released>& out);

  bool contains(std::uint32_t node) const { return loadedPlanes(node) > 0; }
  /// StreamedNode::loadedPlanes() of the resident node, 0 when there is none.
  int loadedPlanes(std::uint32_t node) const;
  /// The resident node, null when there is none. Does not pin it or mark it as wanted.
  Data peek(std::uint32_t node) const;
  NodeCacheStats stats() const;
  std::uint64_t capacityBytes() const { return capacityBytes_; }

 private:
  /// A node that is resident, or one whose data is null that is only remembered for its resident children.
  struct Entry {
    std::shared_ptr<StreamedNode> data;
    std::uint64_t bytes = 0;
    std::uint64_t order = 0;  ///< grows each time that a node is wanted
    std::uint32_t pins = 0;
    std::uint32_t residentChildren = 0;
    std::uint32_t heldChildren = 0;            ///< resident children that may not be evicted
    std::list<std::uint32_t>::iterator place;  ///< in recency_

    bool held() const { return data != nullptr && (pins > 0 || heldChildren > 0); }
    bool evictable() const { return data != nullptr && pins == 0 && residentChildren == 0; }
  };
  /// A poorer version that was replaced while a render list held it.
  struct Retired {
    std::shared_ptr<StreamedNode> data;
    std::uint64_t bytes = 0;
    std::uint32_t pins = 0;
  };

  Entry* find(std::uint32_t node) STRATA_REQUIRES(mutex_);         ///< null when not resident
  Entry* parentEntry(std::uint32_t node) STRATA_REQUIRES(mutex_);  ///< null for the root; the node is resident
  void addPin(std::uint32_t node, Entry& entry) STRATA_REQUIRES(mutex_);
  void dropPin(std::uint32_t node, Entry& entry) STRATA_REQUIRES(mutex_);
  void nowHeld(std::uint32_t node, Entry& entry) STRATA_REQUIRES(mutex_);
  void nowFree(std::uint32_t node, Entry& entry) STRATA_REQUIRES(mutex_);
  bool makeRoom(std::uint32_t node, Entry* present, std::uint64_t bytes, std::vector<Released>& out)
      STRATA_REQUIRES(mutex_);
  void evictUntil(std::uint64_t targetBytes, std::vector<Released>& out) STRATA_REQUIRES(mutex_);
  void evict(std::uint32_t node, Entry& entry, std::vector<Released>& out) STRATA_REQUIRES(mutex_);
  void addEntry(std::uint32_t node, std::shared_ptr<StreamedNode> data, std::uint64_t bytes) STRATA_REQUIRES(mutex_);
  void replaceData(std::uint32_t node, Entry& entry, std::shared_ptr<StreamedNode> data, std::uint64_t bytes,
                   std::vector<Released>& out) STRATA_REQUIRES(mutex_);
  void addBytes(std::uint64_t bytes) STRATA_REQUIRES(mutex_);

  // Constant after construction.
  const std::uint64_t capacityBytes_;
  const std::span<const std::uint32_t> parents_;

  mutable Mutex mutex_;
  std::unordered_map<std::uint32_t, Entry> entries_ STRATA_GUARDED_BY(mutex_);
  std::list<std::uint32_t> recency_ STRATA_GUARDED_BY(mutex_);  ///< resident nodes, the most recently wanted first
  std::vector<Retired> retired_ STRATA_GUARDED_BY(mutex_);
  std::uint64_t retiredBytes_ STRATA_GUARDED_BY(mutex_) = 0;
  std::uint64_t order_ STRATA_GUARDED_BY(mutex_) = 0;
  NodeCacheStats stats_ STRATA_GUARDED_BY(mutex_);
};

}  // namespace strata
