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

/// How densely the pixels of an overdraw picture are covered: the count that gets the last colour.
std::uint32_t largestCount(const std::vector<std::uint32_t>& counts) {
  return counts.empty() ? 1 : std::max(*std::max_element(counts.begin(), counts.end()), 2u);
}

std::uint32_t meanColour(const ColourSum& sum) {
  const auto mean = [&sum](std::uint32_t total) {
    return static_cast<int>((std::uint64_t{total} + sum.count() / 2) / sum.count());
  };
  return packColour(mean(sum.red()), mean(sum.green()), mean(sum.blue()));
}

/// Gives each pixel of the buffer its own colour, in no light and one pixel wide.
class Colouring {
 public:
  Colouring(const RenderList& list, const View& view, const DrawOptions& options, const VisibilityBuffer& buffer)
      : lookup_(list), constants_(viewConstants(view)), options_(options), buffer_(buffer) {
    const bool overdraw = options.colour == ColourMode::overdraw && buffer.counts.size() == buffer.pixels.size();
    if (overdraw) largestCount_ = largestCount(buffer.counts);
    plainRgb_ = options.colour == ColourMode::rgb && options.shading == Shading::plain;
    blended_ = !overdraw && options.shading == Shading::highQuality && buffer.sums.size() == buffer.pixels.size();
  }

  /// Of pixels [begin, end). Points of one row are scattered in memory: some pixels' attributes are asked for ahead.
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
    const std::uint32_t* places[kPixelsAhead];
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t id = pixelId(buffer_.pixels[i]);
      places[i - begin] = &missing;
      if (id == Picture::kNoPoint) continue;
      const PointPlace place = lookup_.find(id);
      if (!place.node->colour.empty()) places[i - begin] = &place.node->colour[place.index];
      __builtin_prefetch(places[i - begin]);
    }
    for (std::size_t i = begin; i < end; ++i) out[i - begin] = *places[i - begin];
  }

  void colourSome(std::size_t begin, std::size_t end, std::uint32_t* out) const {
    PointPlace places[kPixelsAhead];
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t id = pixelId(buffer_.pixels[i]);
      places[i - begin] = id == Picture::kNoPoint || blended_ ? PointPlace{} : lookup_.find(id);
      if (places[i - begin].node != nullptr)
        prefetchColour(*places[i - begin].node, places[i - begin].index, options_.colour);
    }
    for (std::size_t i = begin; i < end; ++i)
      if (pixelId(buffer_.pixels[i]) != Picture::kNoPoint) out[i - begin] = colourOne(i, places[i - begin]);
  }

  std::uint32_t colourOne(std::size_t pixel, const PointPlace& place) const {
    if (largestCount_ > 0) return heat(buffer_.counts[pixel]);
    if (blended_) return buffer_.sums[pixel].count() > 0 ? meanColour(buffer_.sums[pixel]) : missingColour();
    return options_.colour == ColourMode::precision ? precisionColour(precision(place)) : plain(place);
  }

  std::uint32_t plain(const PointPlace& place) const {
    return pointColour(*place.node, place.index, options_, Precision::low10);
  }
  int precision(const PointPlace& place) const {
    return static_cast<int>(batchPrecision(constants_, *place.node, batchOf(*place.node, place.index)));
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

/// Of row y of `height`.
std::uint32_t backgroundColour(const DrawOptions& options, int y, int height) {
  const glm::u8vec3 above = options.background, below = options.backgroundBelow.value_or(above);
  const double t = height > 1 ? static_cast<double>(y) / (height - 1) : 0.0;
  const auto mix = [t](int from, int to) { return static_cast<int>(std::lround(from + (to - from) * t)); };
  return packColour(mix(above.x, below.x), mix(above.y, below.y), mix(above.z, below.z));
}

/// Gives pixels [begin, end) their own index where their id is, so that dilation moves pixels, not points.
void pointAtPixels(VisibilityBuffer& buffer, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    buffer.scratch.ids[i] = pixelId(buffer.pixels[i]);
    if (buffer.scratch.ids[i] != Picture::kNoPoint) buffer.pixels[i] = buffer.pixels[i] >> 32 << 32 | i;
  }
}

/// Fills row y of the frame from the buffer, whose pixels say where their colour and id stand in `colours` and `ids`;
/// with `ids` null they hold their ids, and the colours are in the frame.
void finishRow(const VisibilityBuffer& buffer, const View& view, const DrawOptions& options, std::size_t y,
               const std::uint32_t* colours, const std::uint32_t* ids, Picture& frame) {
  const auto width = static_cast<std::size_t>(buffer.width);
  const std::uint32_t background =
      backgroundColour(options, view.tile.top + static_cast<int>(y), wholePicture(view).height);
  for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
    const std::uint32_t from = pixelId(buffer.pixels[i]);
    frame.depth[i] = pixelDepth(buffer.pixels[i]);
    if (from == Picture::kNoPoint) {
      frame.pointId[i] = from;
      frame.colour[i] = background;
    } else {
      frame.pointId[i] = ids == nullptr ? from : ids[from];
      if (ids != nullptr) frame.colour[i] = colours[from];
    }
  }
}

/// After floodFill(): the frame takes from the buffer, whose points are as large as asked for by now, what fills a
/// pixel that is empty or farther away than kBlendDepth.
void takeLargePoints(const VisibilityBuffer& buffer, const ThreadPool& pool, Picture& frame) {
  pool.parallelFor(buffer.pixels.size(), kRowsAtOnce * 1024, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const std::uint32_t from = pixelId(buffer.pixels[i]);
      const float depth = pixelDepth(buffer.pixels[i]);
      if (from == Picture::kNoPoint) continue;
      if (frame.pointId[i] != Picture::kNoPoint && frame.depth[i] <= depth * DrawOptions::kBlendDepth) continue;
      frame.depth[i] = depth;
      frame.colour[i] = buffer.scratch.colours[from];
      frame.pointId[i] = buffer.scratch.ids[from];
    }
  });
}

}  // namespace

void resolveFrame(const RenderList& list, const View& view, const DrawOptions& options, VisibilityBuffer& buffer,
                  const ThreadPool& pool, Picture& frame, GlFlood* flood) {
  const std::size_t count = buffer.pixels.size();
  const auto width = static_cast<std::size_t>(buffer.width);
  const auto height = static_cast<std::size_t>(std::max(buffer.height, 0));
  frame.width = buffer.width;
  frame.height = buffer.height;
  frame.colour.resize(count);
  frame.depth.resize(count);
  frame.pointId.resize(count);
  const Colouring colouring(list, view, options, buffer);
  const PointSizes sizes = options.colour == ColourMode::overdraw ? PointSizes(1) : PointSizes(options, view);
  const FillSizes fills(options, view);
  if (sizes.alwaysOne() && fills.none()) {
    pool.parallelFor(height, kRowsAtOnce, [&](std::size_t first, std::size_t end) {
      for (std::size_t y = first; y < end; ++y) {
        colouring.colour(y * width, (y + 1) * width, frame.colour.data() + y * width);
        finishRow(buffer, view, options, y, nullptr, nullptr, frame);
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
      for (std::size_t y = first; y < end; ++y)
        finishRow(buffer, view, options, y, buffer.scratch.colours.data(), buffer.scratch.ids.data(), frame);
    });
  }
  if (options.jumpFlood) {
    if (flood != nullptr)
      flood->fill(list, view, {}, pool, frame);
    else
      floodFill(list, view, {}, pool, frame);
    dilate(buffer, sizes, pool);
    if (!sizes.alwaysOne()) takeLargePoints(buffer, pool, frame);
  }
  if (options.edl) eyeDomeLighting(frame, options.edlStrength, sizes, buffer.scratch.depths, pool);
}

}  // namespace strata
