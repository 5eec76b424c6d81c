#include "render/picture/resolve.h"

#include <algorithm>
#include <cmath>

#include "render/flood/flood_fill.h"
#include "render/flood/gl_flood.h"
#include "render/picture/colour_map.h"
#include "render/picture/point_colour.h"
#include "render/picture/post_process.h"
#include "render/plan/batch_plan.h"
#include "render/plan/point_location.h"

namespace strata {
namespace {

constexpr std::size_t kPixelsAhead = 32;
constexpr std::size_t kRowsAtOnce = 16;

/// The count that gets the last colour of an overdraw picture.
std::uint32_t largestCount(const std::vector<std::uint32_t>& counts) {
  return counts.empty() ? 1 : std::max(*std::max_element(counts.begin(), counts.end()), 2u);
}

std::uint32_t meanColour(const ColourSum& sum) {
  const auto mean = [&sum](std::uint32_t total) {
    return static_cast<int>((std::uint64_t{total} + sum.count() / 2) / sum.count());
  };
  return packColour(mean(sum.red()), mean(sum.green()), mean(sum.blue()));
}

/// Computes the colour of the point that each pixel of the buffer shows, without lighting.
class Colouring {
 public:
  Colouring(const RenderList& list, const View& view, const DrawOptions& options, const VisibilityBuffer& buffer)
      : lookup_(list), constants_(viewConstants(view)), options_(options), buffer_(buffer) {
    const bool overdraw = options.colour == ColourMode::overdraw && buffer.counts.size() == buffer.pixels.size();
    if (overdraw) largestCount_ = largestCount(buffer.counts);
    plainRgb_ = options.colour == ColourMode::rgb && options.shading == Shading::plain;
    blended_ = !overdraw && options.shading == Shading::highQuality && buffer.sums.size() == buffer.pixels.size();
  }

  /// Colours pixels [begin, end). The points of a row are scattered in memory, so the attributes of several pixels are
  /// prefetched before the first is used.
  void colour(std::size_t begin, std::size_t end, std::uint32_t* out) const {
    for (std::size_t i = begin; i < end; i += kPixelsAhead) {
      const std::size_t last = std::min(i + kPixelsAhead, end);
      if (plainRgb_)
        copyRgb(i, last, out + (i - begin));
      else
        colourSome(i, last, out + (i - begin));
    }
  }

 private:
  void copyRgb(std::size_t begin, std::size_t end, std::uint32_t* out) const {
    static const std::uint32_t missing = missingColour();
    const std::uint32_t* found[kPixelsAhead];
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t id = pixelId(buffer_.pixels[i]);
      found[i - begin] = &missing;
      if (id == Picture::kNoPoint) continue;
      const PointLocation location = lookup_.find(id);
      if (!location.node->colour.empty()) found[i - begin] = &location.node->colour[location.index];
      __builtin_prefetch(found[i - begin]);
    }
    for (std::size_t i = begin; i < end; ++i) out[i - begin] = *found[i - begin];
  }

  void colourSome(std::size_t begin, std::size_t end, std::uint32_t* out) const {
    PointLocation locations[kPixelsAhead];
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t id = pixelId(buffer_.pixels[i]);
      locations[i - begin] = id == Picture::kNoPoint || blended_ ? PointLocation{} : lookup_.find(id);
      if (locations[i - begin].node != nullptr)
        prefetchColour(*locations[i - begin].node, locations[i - begin].index, options_.colour);
    }
    for (std::size_t i = begin; i < end; ++i)
      if (pixelId(buffer_.pixels[i]) != Picture::kNoPoint) out[i - begin] = colourOne(i, locations[i - begin]);
  }

  std::uint32_t colourOne(std::size_t pixel, const PointLocation& location) const {
    if (largestCount_ > 0) return heat(buffer_.counts[pixel]);
    if (blended_) return buffer_.sums[pixel].count() > 0 ? meanColour(buffer_.sums[pixel]) : missingColour();
    return options_.colour == ColourMode::precision ? precisionColour(precision(location)) : plain(location);
  }

  std::uint32_t plain(const PointLocation& location) const {
    return pointColour(*location.node, location.index, options_, Precision::low10);
  }
  int precision(const PointLocation& location) const {
    return static_cast<int>(batchPrecision(constants_, *location.node, batchOf(*location.node, location.index)));
  }
  std::uint32_t heat(std::uint32_t count) const {
    return heatColour(std::log2(std::max(count, 1u)) / std::log2(largestCount_));
  }

  PointFinder lookup_;
  ViewConstants constants_;
  const DrawOptions& options_;
  const VisibilityBuffer& buffer_;
  std::uint32_t largestCount_ = 0;  ///< 0: no overdraw picture
  bool plainRgb_ = false;
  bool blended_ = false;
};

/// The background colour of row y of a picture `height` rows high.
std::uint32_t backgroundColour(const DrawOptions& options, int y, int height) {
  const glm::u8vec3 above = options.background, below = options.backgroundBelow.value_or(above);
  const double t = height > 1 ? static_cast<double>(y) / (height - 1) : 0.0;
  const auto mix = [t](int from, int to) { return static_cast<int>(std::lround(from + (to - from) * t)); };
  return packColour(mix(above.x, below.x), mix(above.y, below.y), mix(above.z, below.z));
}

/// Replaces the ids of pixels [begin, end) by the pixels' own indices, so that dilation moves pixels together with
/// their colours. The ids go to the scratch memory.
void pointAtPixels(VisibilityBuffer& buffer, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    buffer.scratch.ids[i] = pixelId(buffer.pixels[i]);
    if (buffer.scratch.ids[i] != Picture::kNoPoint) buffer.pixels[i] = buffer.pixels[i] >> 32 << 32 | i;
  }
}

/// Fills row y of the picture. With `indexed`, each pixel of the buffer holds the index of the pixel whose colour and
/// id it takes from the scratch memory (see pointAtPixels()); else it holds its own id, and its colour is already
/// there.
void finishRow(const DrawnScene& drawn, const VisibilityBuffer& buffer, std::size_t y, bool indexed, Picture& picture) {
  const auto width = static_cast<std::size_t>(buffer.width);
  const std::uint32_t background =
      backgroundColour(drawn.options, drawn.view.tile.top + static_cast<int>(y), wholePicture(drawn.view).height);
  for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
    const std::uint32_t from = pixelId(buffer.pixels[i]);
    picture.depth[i] = pixelDepth(buffer.pixels[i]);
    if (from == Picture::kNoPoint) {
      picture.pointId[i] = from;
      picture.colour[i] = background;
    } else {
      picture.pointId[i] = indexed ? buffer.scratch.ids[from] : from;
      if (indexed) picture.colour[i] = buffer.scratch.colours[from];
    }
  }
}

/// After floodFill(): takes the pixels of the buffer, whose points have their full size by now, into the pixels of the
/// picture that are empty or more than kBlendDepth farther away.
void takeLargePoints(const VisibilityBuffer& buffer, const ThreadPool& pool, Picture& picture) {
  pool.parallelFor(buffer.pixels.size(), kRowsAtOnce * 1024, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const std::uint32_t from = pixelId(buffer.pixels[i]);
      const float depth = pixelDepth(buffer.pixels[i]);
      if (from == Picture::kNoPoint) continue;
      if (picture.pointId[i] != Picture::kNoPoint && picture.depth[i] <= depth * DrawOptions::kBlendDepth) continue;
      picture.depth[i] = depth;
      picture.colour[i] = buffer.scratch.colours[from];
      picture.pointId[i] = buffer.scratch.ids[from];
    }
  });
}

}  // namespace

void resolvePicture(const DrawnScene& drawn, const ResolveTools& tools, VisibilityBuffer& buffer, Picture& picture) {
  const auto& [list, view, options] = drawn;
  const ThreadPool& pool = tools.pool;
  const std::size_t count = buffer.pixels.size();
  const auto width = static_cast<std::size_t>(buffer.width);
  const auto height = static_cast<std::size_t>(std::max(buffer.height, 0));
  picture.width = buffer.width;
  picture.height = buffer.height;
  picture.colour.resize(count);
  picture.depth.resize(count);
  picture.pointId.resize(count);
  const Colouring colouring(list, view, options, buffer);
  const PointSizes sizes = options.colour == ColourMode::overdraw ? PointSizes(1) : PointSizes(options, view);
  const FillSizes fills(options, view);
  if (sizes.alwaysOne() && fills.none()) {
    pool.parallelFor(height, kRowsAtOnce, [&](std::size_t first, std::size_t end) {
      for (std::size_t y = first; y < end; ++y) {
        colouring.colour(y * width, (y + 1) * width, picture.colour.data() + y * width);
        finishRow(drawn, buffer, y, false, picture);
      }
    });
  } else {
    buffer.scratch.colours.resize(count);
    buffer.scratch.ids.resize(count);
    pool.parallelFor(height, kRowsAtOnce, [&](std::size_t first, std::size_t end) {
      colouring.colour(first * width, end * width, buffer.scratch.colours.data() + first * width);
      pointAtPixels(buffer, first * width, end * width);
    });
    if (!options.jumpFlood) dilate(buffer, sizes, pool);
    fillHoles(buffer, fills, pool);
    pool.parallelFor(height, kRowsAtOnce, [&](std::size_t first, std::size_t end) {
      for (std::size_t y = first; y < end; ++y) finishRow(drawn, buffer, y, true, picture);
    });
  }
  if (options.jumpFlood) {
    if (tools.flood != nullptr)
      tools.flood->fill(list, view, {}, pool, picture);
    else
      floodFill(list, view, {}, pool, picture);
    dilate(buffer, sizes, pool);
    if (!sizes.alwaysOne()) takeLargePoints(buffer, pool, picture);
  }
  if (options.edl) eyeDomeLighting(picture, options.edlStrength, sizes, buffer.scratch.depths, pool);
}

}  // namespace strata
