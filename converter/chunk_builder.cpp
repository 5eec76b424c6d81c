#include "converter/chunk_builder.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <utility>

namespace strata {
namespace {

constexpr int kDigitBits = 11;

class ChunkBuilder {
 public:
  ChunkBuilder(const BuildFrame& frame, NodeKey cell, std::vector<std::byte> points)
      : frame_(frame), cell_(cell), points_(std::move(points)), keyLevels_(frame.keyLevels(cell)) {
    const std::size_t stride = frame.format.stride();
    keys_.resize(points_.size() / stride);
    index_.resize(keys_.size());
    for (std::size_t i = 0; i < keys_.size(); ++i) keys_[i] = frame.key(cell, points_.data() + i * stride);
    std::iota(index_.begin(), index_.end(), 0u);
    sortByKey(keys_, index_, 3 * keyLevels_);
  }

  BuiltChunk build() {
    BuiltChunk out;
    std::size_t end = keys_.size();
    out.topPoints = takeOwnPoints(cell_, 0, end);
    out.topChildren = buildChildren(cell_, 0, end, out.nodes);
    return out;
  }

 private:
  /// Removes the node's own points from the range and returns them; `end` moves down.
  std::vector<std::byte> takeOwnPoints(NodeKey key, std::size_t begin, std::size_t& end) {
    const std::size_t capacity = frame_.info.nodePoints;
    const int levelsBelow = keyLevels_ - (key.level() - cell_.level());
    const bool deepest = key.level() >= NodeKey::kDeepestLevel || levelsBelow <= 0;
    const bool allAlike = begin < end && keys_[begin] == keys_[end - 1];
    std::vector<std::uint32_t> own;
    if (end - begin <= capacity || deepest || allAlike) {
      own.assign(index_.begin() + static_cast<std::ptrdiff_t>(begin),
                 index_.begin() + static_cast<std::ptrdiff_t>(end));
      end = begin;
    } else {
      const std::uint64_t inside = (std::uint64_t{1} << (3 * levelsBelow)) - 1;
      std::vector<std::uint64_t> local(keys_.begin() + static_cast<std::ptrdiff_t>(begin),
                                       keys_.begin() + static_cast<std::ptrdiff_t>(end));
      for (std::uint64_t& k : local) k &= inside;
      const std::vector<std::uint32_t> kept = selectRepresentatives({local, levelsBelow}, capacity);
      own = removeFromRange(kept, begin, end);
    }
    std::vector<std::byte> packed(own.size() * frame_.format.stride());
    for (std::size_t i = 0; i < own.size(); ++i)
      std::memcpy(packed.data() + i * frame_.format.stride(), points_.data() + own[i] * frame_.format.stride(),
                  frame_.format.stride());
    return packed;
  }

  /// Takes the points at begin + kept[...] out of the range, which closes up; returns their indices.
  std::vector<std::uint32_t> removeFromRange(const std::vector<std::uint32_t>& kept, std::size_t begin,
                                             std::size_t& end) {
    std::vector<std::uint32_t> removed;
    removed.reserve(kept.size());
    std::size_t to = begin;
    std::size_t next = 0;
    for (std::size_t from = begin; from < end; ++from) {
      if (next < kept.size() && begin + kept[next] == from) {
        removed.push_back(index_[from]);
        ++next;
      } else {
        keys_[to] = keys_[from];
        index_[to++] = index_[from];
      }
    }
    end = to;
    return removed;
  }

  std::vector<SubtreeShape> buildChildren(NodeKey parent, std::size_t begin, std::size_t end,
                                          std::vector<BuiltNode>& nodes) {
    std::vector<SubtreeShape> shapes;
    const int shift = 3 * (keyLevels_ - (parent.level() - cell_.level()) - 1);
    while (begin < end) {
      const std::uint64_t cell = keys_[begin] >> shift;
      const auto last = std::partition_point(keys_.begin() + static_cast<std::ptrdiff_t>(begin),
                                             keys_.begin() + static_cast<std::ptrdiff_t>(end),
                                             [&](std::uint64_t k) { return k >> shift == cell; });
      const auto childEnd = static_cast<std::size_t>(last - keys_.begin());
      shapes.push_back(buildNode(parent.child(static_cast<int>(cell & 7)), begin, childEnd, nodes));
      begin = childEnd;
    }
    return shapes;
  }

  SubtreeShape buildNode(NodeKey key, std::size_t begin, std::size_t end, std::vector<BuiltNode>& nodes) {
    const std::size_t place = nodes.size();
    nodes.emplace_back();
    const std::vector<std::byte> own = takeOwnPoints(key, begin, end);
    const std::vector<SubtreeShape> children = buildChildren(key, begin, end, nodes);
    FinishedNode finished = finishNode(frame_, key, own, children);
    nodes[place] = std::move(finished.node);
    return finished.shape;
  }

  const BuildFrame& frame_;
  const NodeKey cell_;
  const std::vector<std::byte> points_;
  const int keyLevels_;
  std::vector<std::uint64_t> keys_;   ///< ascending
  std::vector<std::uint32_t> index_;  ///< into points_, along with keys_
};

}  // namespace

void sortByKey(std::vector<std::uint64_t>& keys, std::vector<std::uint32_t>& index, int keyBits) {
  std::vector<std::uint64_t> keys2(keys.size());
  std::vector<std::uint32_t> index2(index.size());
  std::uint64_t differing = 0;
  for (const std::uint64_t k : keys) differing |= k ^ keys.front();
  for (int shift = 0; shift < keyBits; shift += kDigitBits) {
    constexpr std::uint64_t kMask = (1u << kDigitBits) - 1;
    if ((differing >> shift & kMask) == 0) continue;
    std::array<std::size_t, kMask + 2> starts{};
    for (const std::uint64_t k : keys) ++starts[(k >> shift & kMask) + 1];
    std::partial_sum(starts.begin(), starts.end(), starts.begin());
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const std::size_t to = starts[keys[i] >> shift & kMask]++;
      keys2[to] = keys[i];
      index2[to] = index[i];
    }
    keys.swap(keys2);
    index.swap(index2);
  }
}

BuiltChunk buildChunk(const BuildFrame& frame, NodeKey cell, std::vector<std::byte> points) {
  return ChunkBuilder(frame, cell, std::move(points)).build();
}

}  // namespace strata
