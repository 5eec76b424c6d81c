#include "render/post_process.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace strata {
namespace {

constexpr std::size_t kRowsAtOnce = 16;
constexpr float kEdlGain = 40.0f;  ///< a depth step of 1 % to all neighbours darkens to about 0.6 at strength 1

std::uint32_t scaleColour(std::uint32_t colour, float factor) {
  std::uint32_t result = colour & 0xff000000u;
  for (int shift = 0; shift < 24; shift += 8) {
    const float channel = static_cast<float>(colour >> shift & 255u) * factor;
    result |= static_cast<std::uint32_t>(channel + 0.5f) << shift;
  }
  return result;
}

}  // namespace

PointSizes::PointSizes(int pixels) : least_(std::clamp(pixels, 1, DrawOptions::kLargestPoint)) {}

PointSizes::PointSizes(const DrawOptions& options, const View& view)
    : least_(std::clamp(options.pointSize, 1, DrawOptions::kLargestPoint)), perspective_(!view.orthographic) {
  if (options.pointMetres <= 0.0f) return;
  View unit = view;
  unit.nearPlane = 0.0;
  pixelsAtUnitDepth_ = static_cast<float>(pixelsAt(unit, static_cast<double>(options.pointMetres), 1.0));
}

void dilate(VisibilityBuffer& buffer, const PointSizes& sizes, const ThreadPool& pool) {
  if (sizes.alwaysOne()) return;
  const auto width = static_cast<std::size_t>(buffer.width);
  const auto height = static_cast<std::size_t>(buffer.height);
  std::vector<PackedPixel> rows(buffer.pixels.size(), kEmptyPixel);
  std::vector<std::uint8_t> sizeOf(rows.size(), 1);  // of the point in `rows`
  std::atomic<int> largest{1};
  pool.parallelFor(height, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    int largestHere = 1;
    for (std::size_t y = begin; y < end; ++y) {
      const PackedPixel* from = &buffer.pixels[y * width];
      PackedPixel* to = &rows[y * width];
      for (std::size_t x = 0; x < width; ++x) {
        if (from[x] == kEmptyPixel) continue;
        const auto size = static_cast<std::size_t>(sizes.at(pixelDepth(from[x])));
        const std::size_t last = std::min(x + size / 2, width - 1);
        for (std::size_t i = x - std::min(x, (size - 1) / 2); i <= last; ++i) to[i] = std::min(to[i], from[x]);
      }
      for (std::size_t x = 0; x < width; ++x)
        if (to[x] != kEmptyPixel) {
          const int size = sizes.at(pixelDepth(to[x]));
          sizeOf[y * width + x] = static_cast<std::uint8_t>(size);
          largestHere = std::max(largestHere, size);
        }
    }
    int seen = largest;
    while (largestHere > seen && !largest.compare_exchange_weak(seen, largestHere)) {
    }
  });
  const auto reach = static_cast<std::size_t>(largest.load());
  pool.parallelFor(height, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      PackedPixel* to = &buffer.pixels[y * width];
      std::fill_n(to, width, kEmptyPixel);
      const std::size_t last = std::min(y + (reach - 1) / 2, height - 1);
      for (std::size_t row = y - std::min(y, reach / 2); row <= last; ++row) {
        const PackedPixel* from = &rows[row * width];
        const std::uint8_t* size = &sizeOf[row * width];
        // Reaches down by size / 2 and up by (size - 1) / 2.
        const std::size_t least = row <= y ? 2 * (y - row) : 2 * (row - y) + 1;
        for (std::size_t x = 0; x < width; ++x) to[x] = size[x] >= least ? std::min(to[x], from[x]) : to[x];
      }
    }
  });
}

void eyeDomeLighting(Frame& frame, float strength, const PointSizes& sizes, const ThreadPool& pool) {
  const auto width = static_cast<std::size_t>(frame.width);
  const auto height = static_cast<std::size_t>(frame.height);
  std::vector<float> logDepth(frame.depth.size());
  pool.parallelFor(height, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * width; i < end * width; ++i)
      logDepth[i] = frame.pointId[i] == Frame::kNoPoint ? std::numeric_limits<float>::infinity()
                                                        : std::log2(std::max(frame.depth[i], 1e-30f));
  });
  pool.parallelFor(height, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t at = y * width + x;
        if (frame.pointId[at] == Frame::kNoPoint) continue;
        const auto apart = static_cast<std::size_t>(sizes.at(frame.depth[at]));
        const std::size_t rows[3] = {y - std::min(y, apart), y, std::min(y + apart, height - 1)};
        const std::size_t columns[3] = {x - std::min(x, apart), x, std::min(x + apart, width - 1)};
        float inFront = 0.0f;
        for (const std::size_t row : rows)
          for (const std::size_t column : columns)
            inFront += std::max(0.0f, logDepth[at] - logDepth[row * width + column]);
        const float gain = kEdlGain / 8.0f * strength / static_cast<float>(apart);
        if (inFront > 0.0f) frame.colour[at] = scaleColour(frame.colour[at], std::exp(-inFront * gain));
      }
  });
}

}  // namespace strata
