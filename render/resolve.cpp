#include "render/resolve.h"

#include <algorithm>
#include <cmath>

#include "render/colour_map.h"
#include "render/post_process.h"

namespace strata {
namespace {

constexpr std::size_t kPixelsAtOnce = std::size_t{1} << 15;  ///< by one thread
constexpr std::size_t kPixelsAhead = 32;

/// Where a point lies.
struct PointPlace {
  const NodeData* node;
  std::uint32_t index;
};

/// Finds the node of an id: a table says which items a block of ids meets, a search among those finishes.
class PointLookup {
 public:
  explicit PointLookup(const RenderList& list) : list_(list) {
    for (const RenderItem& item : list.items) starts_.push_back(starts_.back() + item.pointCount);
    std::uint32_t item = 0;
    for (std::uint64_t id = 0; id < starts_.back(); id += kBlock) {
      while (starts_[item + 1] <= id) ++item;
      itemAt_.push_back(item);
    }
    if (!list.items.empty()) itemAt_.push_back(static_cast<std::uint32_t>(list.items.size() - 1));
  }

  PointPlace find(std::uint32_t id) const {
    const std::uint32_t block = id / kBlock;
    const auto begin = starts_.begin() + itemAt_[block] + 1, end = starts_.begin() + itemAt_[block + 1] + 1;
    const auto item = static_cast<std::size_t>(std::upper_bound(begin, end, id) - starts_.begin()) - 1;
    return {list_.items[item].node.get(), id - starts_[item]};
  }

 private:
  static constexpr std::uint32_t kBlock = 4096;

  const RenderList& list_;
  std::vector<std::uint32_t> starts_{0};  ///< first id of each item, then the end
  std::vector<std::uint32_t> itemAt_;     ///< of the first id of each block; the last item at the end
};

/// Points of one pixel row are scattered in memory; asking for some pixels' attributes ahead hides that.
void prefetch(const PointPlace& place, ColourMode mode) {
  const NodeData& node = *place.node;
  if (mode == ColourMode::rgb && !node.colour.empty()) __builtin_prefetch(&node.colour[place.index]);
  if (mode == ColourMode::intensity && !node.intensity.empty()) __builtin_prefetch(&node.intensity[place.index]);
  if (mode == ColourMode::classification && !node.classification.empty())
    __builtin_prefetch(&node.classification[place.index]);
  if (mode == ColourMode::elevation) __builtin_prefetch(&node.position[0][place.index]);
}

double elevation(const NodeData& node, std::uint32_t point) {
  const auto after = std::upper_bound(node.batches.begin(), node.batches.end(), point,
                                      [](std::uint32_t p, const Batch& batch) { return p < batch.firstPoint; });
  return pointPosition(node, *(after - 1), point, static_cast<Precision>(node.loadedPlanes())).z;
}

std::uint32_t pointColour(const NodeData& node, std::uint32_t point, const DrawOptions& options) {
  switch (options.colour) {
    case ColourMode::rgb:
      return node.colour.empty() ? missingColour() : node.colour[point];
    case ColourMode::intensity: {
      if (node.intensity.empty()) return missingColour();
      const float span = std::max(options.intensityRange.y - options.intensityRange.x, 1e-6f);
      const float t = (static_cast<float>(node.intensity[point]) - options.intensityRange.x) / span;
      // The square root: what scanners record spans decades, and most of a scan is in the dark tenth of the range.
      const int grey = static_cast<int>(std::sqrt(std::clamp(t, 0.0f, 1.0f)) * 255.0f + 0.5f);
      return packColour(grey, grey, grey);
    }
    case ColourMode::elevation: {
      const double span = std::max(options.elevationRange.y - options.elevationRange.x, 1e-9);
      return elevationColour((elevation(node, point) - options.elevationRange.x) / span);
    }
    case ColourMode::classification:
      return node.classification.empty() ? missingColour() : classificationColour(node.classification[point]);
    case ColourMode::level:
      return levelColour(node.key.level());
  }
  return missingColour();
}

}  // namespace

void resolveFrame(const RenderList& list, const View& view, const DrawOptions& options, VisibilityBuffer& buffer,
                  const ThreadPool& pool, Frame& frame) {
  const PointSizes sizes(options, view);
  dilate(buffer, sizes, pool);

  const PointLookup lookup(list);
  const std::uint32_t background = packColour(options.background.x, options.background.y, options.background.z);
  const std::size_t count = buffer.pixels.size();
  frame.width = buffer.width;
  frame.height = buffer.height;
  frame.colour.resize(count);
  frame.depth.resize(count);
  frame.pointId.resize(count);
  const auto resolvePixels = [&](std::size_t begin, std::size_t end) {
    PointPlace places[kPixelsAhead];
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t id = pixelId(buffer.pixels[i]);
      frame.depth[i] = pixelDepth(buffer.pixels[i]);
      frame.pointId[i] = id;
      places[i - begin] = id == Frame::kNoPoint ? PointPlace{nullptr, 0} : lookup.find(id);
      if (id != Frame::kNoPoint) prefetch(places[i - begin], options.colour);
    }
    for (std::size_t i = begin; i < end; ++i) {
      const PointPlace& place = places[i - begin];
      frame.colour[i] = place.node == nullptr ? background : pointColour(*place.node, place.index, options);
    }
  };
  pool.parallelFor(count, kPixelsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; i += kPixelsAhead) resolvePixels(i, std::min(i + kPixelsAhead, end));
  });
  if (options.edl) eyeDomeLighting(frame, options.edlStrength, sizes, pool);
}

}  // namespace strata
