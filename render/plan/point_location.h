#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/render_list.h"

namespace strata {

/// The node and the item of the list that a point belongs to.
struct PointLocation {
  const NodeData* node = nullptr;
  std::uint32_t index = 0;  ///< within the node
  std::size_t item = 0;     ///< into RenderList::items
};

/// Finds the node that a point id of a list belongs to. A table tells which items each block of 4096 ids spans, and a
/// search among those finds the one.
class PointFinder {
 public:
  explicit PointFinder(const RenderList& list) {
    for (const RenderItem& item : list.items) {
      starts_.push_back(starts_.back() + item.pointCount);
      nodes_.push_back(item.node.get());
    }
    std::uint32_t item = 0;
    for (std::uint64_t id = 0; id < starts_.back(); id += kBlock) {
      while (starts_[item + 1] <= id) ++item;
      itemAt_.push_back(item);
    }
    if (!list.items.empty()) itemAt_.push_back(static_cast<std::uint32_t>(list.items.size() - 1));
  }

  PointLocation find(std::uint32_t id) const {
    const std::uint32_t block = id / kBlock;
    std::size_t item = itemAt_[block];
    if (const std::size_t last = itemAt_[block + 1]; last > item + kFewItems)
      item = static_cast<std::size_t>(std::upper_bound(starts_.begin() + static_cast<std::ptrdiff_t>(item) + 1,
                                                       starts_.begin() + static_cast<std::ptrdiff_t>(last) + 1, id) -
                                      starts_.begin()) -
             1;
    else
      while (item < last && starts_[item + 1] <= id) ++item;
    return {nodes_[item], id - starts_[item], item};
  }

 private:
  static constexpr std::uint32_t kBlock = 4096;
  static constexpr std::size_t kFewItems = 8;  ///< up to so many are searched one by one, which is quicker

  std::vector<const NodeData*> nodes_;
  std::vector<std::uint32_t> starts_{0};  ///< first id of each item, then the end
  std::vector<std::uint32_t> itemAt_;     ///< the item of each block's first id; at the end the last item
};

}  // namespace strata
