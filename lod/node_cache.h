#pragma once
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

#include "lod/streamed_node.h"

namespace strata {

/// All counts since construction, except the last four, which say how it is now.
struct NodeCacheStats {
  std::uint64_t inserted = 0;
  std::uint64_t replaced = 0;  ///< a node that came again with more planes
  std::uint64_t evictions = 0;
  std::uint64_t refusals = 0;       ///< no room beside what may not be evicted
  std::uint64_t duplicates = 0;     ///< turned away because the node was there already, at least as rich
  std::uint64_t residentBytes = 0;  ///< of everything held, replaced nodes that are still drawn included
  std::uint64_t peakBytes = 0;      ///< the most that residentBytes ever was
  std::uint64_t pinnedBytes = 0;    ///< of what may not be evicted: pinned nodes and the nodes above them
  std::uint32_t residentNodes = 0;
};

/// Decoded nodes in host memory, least recently wanted out first (Kanzok 2015, 3.2.1, item 5). At every moment:
///   - residentBytes <= capacityBytes
///   - a pinned node (one that a render list holds) is resident
///   - a node is not evicted while a child of it is resident: what is drawn stays closed under parents
/// A node may come before its parent does. What does not fit is refused and counted.
/// Every member may be called by any thread; none does I/O or frees node memory under the lock.
class NodeCache {
 public:
  using Data = std::shared_ptr<const StreamedNode>;

  /// A hold on one node's data, taken by pin() and given back by unpin().
  struct Pin {
    std::uint32_t node = 0;
    const StreamedNode* data = nullptr;
  };

  enum class Insertion : std::uint8_t { inserted, replaced, refused, duplicate };

  /// `parents` (index of the parent by node index) has to outlive the cache.
  NodeCache(std::uint64_t capacityBytes, std::span<const std::uint32_t> parents);

  /// Takes a node in as the most recently wanted, in place of a poorer version of it if there is one, and evicts as
  /// many as it takes. Appends to `out` what the cache holds no longer, `data` itself when it was not taken.
  Insertion insert(std::uint32_t node, Data data, std::vector<Data>& out);

  /// Pins those of `nodes` (ascending) that are resident and marks them as just wanted, parents last. `found` is
  /// replaced by one entry for each of `nodes`, null where it is not resident; `pins` gets one for each that is.
  void pin(std::span<const std::uint32_t> nodes, std::vector<Data>& found, std::vector<Pin>& pins);
  /// Appends to `out` replaced nodes that nobody holds any more.
  void unpin(std::span<const Pin> pins, std::vector<Data>& out);

  bool contains(std::uint32_t node) const { return loadedPlanes(node) > 0; }
  /// StreamedNode::loadedPlanes() of the resident version, 0 when there is none.
  int loadedPlanes(std::uint32_t node) const;
  /// The resident version, null when there is none. Does not pin it or mark it as wanted.
  Data peek(std::uint32_t node) const;
  NodeCacheStats stats() const;
  std::uint64_t capacityBytes() const { return capacityBytes_; }

 private:
  /// A node that is resident, or (data null) only remembered for its resident children.
  struct Entry {
    Data data;
    std::uint64_t bytes = 0;
    std::uint64_t order = 0;  ///< of the last want; ascending over time
    std::uint32_t pins = 0;
    std::uint32_t residentChildren = 0;
    std::uint32_t heldChildren = 0;  ///< of them, those that may not be evicted
    std::list<std::uint32_t>::iterator place;

    bool held() const { return data != nullptr && (pins > 0 || heldChildren > 0); }
    bool evictable() const { return data != nullptr && pins == 0 && residentChildren == 0; }
  };
  /// A poorer version that was replaced while a render list held it.
  struct Retired {
    Data data;
    std::uint64_t bytes = 0;
    std::uint32_t pins = 0;
  };

  // All with mutex_ held.
  Entry* find(std::uint32_t node);         ///< null when not resident
  Entry* parentEntry(std::uint32_t node);  ///< of a resident node; null for the root
  void addPin(std::uint32_t node, Entry& entry);
  void dropPin(std::uint32_t node, Entry& entry);
  void nowHeld(std::uint32_t node, Entry& entry);
  void nowFree(std::uint32_t node, Entry& entry);
  bool makeRoom(std::uint32_t node, Entry* present, std::uint64_t bytes, std::vector<Data>& out);
  void evictUntil(std::uint64_t targetBytes, std::vector<Data>& out);
  void evict(std::uint32_t node, Entry& entry, std::vector<Data>& out);
  void addEntry(std::uint32_t node, Data data, std::uint64_t bytes);
  void replaceData(std::uint32_t node, Entry& entry, Data data, std::uint64_t bytes, std::vector<Data>& out);
  void addBytes(std::uint64_t bytes);

  // Constant after construction.
  const std::uint64_t capacityBytes_;
  const std::span<const std::uint32_t> parents_;

  // Guarded by mutex_.
  mutable std::mutex mutex_;
  std::unordered_map<std::uint32_t, Entry> entries_;
  std::list<std::uint32_t> recency_;  ///< front = most recently wanted
  std::vector<Retired> retired_;
  std::uint64_t retiredBytes_ = 0;
  std::uint64_t order_ = 0;
  NodeCacheStats stats_;
};

}  // namespace strata
