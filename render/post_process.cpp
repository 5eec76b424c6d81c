#include "render/post_process.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace strata {
namespace {

constexpr std::size_t kRowsAtOnce = 16;
constexpr float kEdlGain = 40.0f;  ///< a depth step of 1 % to all neighbours darkens to about 0.6 at strength 1

/// to[i] = min of from[i - before] to from[i + after], cut at the ends.
void slidingMin(const PackedPixel* from, PackedPixel* to, int count, int before, int after) {
  for (int i = 0; i < count; ++i) {
    PackedPixel nearest = kEmptyPixel;
    const int last = std::min(i + after, count - 1);
    for (int j = std::max(i - before, 0); j <= last; ++j) nearest = std::min(nearest, from[j]);
    to[i] = nearest;
  }
}

std::uint32_t scaleColour(std::uint32_t colour, float factor) {
  std::uint32_t result = colour & 0xff000000u;
  for (int shift = 0; shift < 24; shift += 8) {
    const float channel = static_cast<float>(colour >> shift & 255u) * factor;
    result |= static_cast<std::uint32_t>(channel + 0.5f) << shift;
  }
  return result;
}

}  // namespace

void dilate(VisibilityBuffer& buffer, int pointSize, const ThreadPool& pool) {
  if (pointSize <= 1) return;
  const int before = pointSize / 2;
  const int after = (pointSize - 1) / 2;
  const auto width = static_cast<std::size_t>(buffer.width);
  const auto height = static_cast<std::size_t>(buffer.height);
  std::vector<PackedPixel> rows(buffer.pixels.size());
  pool.parallelFor(height, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      slidingMin(&buffer.pixels[y * width], &rows[y * width], buffer.width, before, after);
  });
  pool.parallelFor(height, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      PackedPixel* to = &buffer.pixels[y * width];
      const std::size_t first = y - std::min(y, static_cast<std::size_t>(before));
      const std::size_t last = std::min(y + static_cast<std::size_t>(after), height - 1);
      std::copy_n(&rows[first * width], width, to);
      for (std::size_t row = first + 1; row <= last; ++row) {
        const PackedPixel* from = &rows[row * width];
        for (std::size_t x = 0; x < width; ++x) to[x] = std::min(to[x], from[x]);
      }
    }
  });
}

void eyeDomeLighting(Frame& frame, float strength, const ThreadPool& pool) {
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
        float inFront = 0.0f;
        const std::size_t top = y == 0 ? 0 : y - 1, bottom = std::min(y + 1, height - 1);
        const std::size_t left = x == 0 ? 0 : x - 1, right = std::min(x + 1, width - 1);
        for (std::size_t row = top; row <= bottom; ++row)
          for (std::size_t column = left; column <= right; ++column)
            inFront += std::max(0.0f, logDepth[at] - logDepth[row * width + column]);
        frame.colour[at] = scaleColour(frame.colour[at], std::exp(-inFront / 8.0f * kEdlGain * strength));
      }
  });
}

}  // namespace strata
