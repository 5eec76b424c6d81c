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

FillSizes::FillSizes(const DrawOptions& options, const View& view)
    : least_(std::clamp(options.fill, 1, DrawOptions::kLargestFill) | 1),
      gaze_(options.gaze.on),
      atX_(options.gaze.at.x * static_cast<float>(view.width)),
      atY_(options.gaze.at.y * static_cast<float>(view.height)),
      third_(static_cast<float>(std::max(view.height, 1)) / 3.0f) {}

int FillSizes::at(int x, int y) const {
  if (!gaze_) return least_;
  const float away = std::hypot(static_cast<float>(x) + 0.5f - atX_, static_cast<float>(y) + 0.5f - atY_);
  return std::max(least_, away < third_ ? 3 : away < 2.0f * third_ ? 5 : 7);
}

namespace {

struct Step {
  int x, y;
};

/// The places of the largest window by their distance from its middle.
std::vector<Step> stepsByDistance() {
  std::vector<Step> steps;
  const int reach = DrawOptions::kLargestFill / 2;
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) steps.push_back({x, y});
  std::stable_sort(steps.begin(), steps.end(),
                   [](const Step& a, const Step& b) { return a.x * a.x + a.y * a.y < b.x * b.x + b.y * b.y; });
  return steps;
}

}  // namespace

void fillHoles(VisibilityBuffer& buffer, const FillSizes& sizes, const ThreadPool& pool) {
  if (sizes.none()) return;
  const std::vector<Step> steps = stepsByDistance();
  const std::vector<PackedPixel> from = buffer.pixels;
  const auto at = [&](int x, int y) {
    return from[static_cast<std::size_t>(y) * static_cast<std::size_t>(buffer.width) + static_cast<std::size_t>(x)];
  };
  const auto filled = [&](int x, int y) {
    const int reach = sizes.at(x, y) / 2;
    const int left = std::max(x - reach, 0), right = std::min(x + reach, buffer.width - 1);
    const int top = std::max(y - reach, 0), bottom = std::min(y + reach, buffer.height - 1);
    PackedPixel front = kEmptyPixel;
    for (int v = top; v <= bottom; ++v)
      for (int u = left; u <= right; ++u) front = std::min(front, at(u, v));
    const float deepest = pixelDepth(front) * DrawOptions::kBlendDepth;
    if (front == kEmptyPixel || pixelDepth(at(x, y)) <= deepest) return at(x, y);
    for (const Step& step : steps) {
      const int u = x + step.x, v = y + step.y;
      if (u < left || u > right || v < top || v > bottom) continue;
      if (pixelDepth(at(u, v)) <= deepest) return at(u, v);
    }
    return at(x, y);
  };
  pool.parallelFor(static_cast<std::size_t>(std::max(buffer.height, 0)), kRowsAtOnce,
                   [&](std::size_t begin, std::size_t end) {
                     for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
                       for (int x = 0; x < buffer.width; ++x)
                         buffer.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(buffer.width) +
                                       static_cast<std::size_t>(x)] = filled(x, y);
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
