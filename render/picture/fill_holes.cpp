#include <algorithm>
#include <cmath>

#include "render/picture/post_kernel.h"
#include "render/picture/post_process.h"

namespace strata {
namespace {

constexpr std::size_t kRowsAtOnce = 16;
constexpr int kReach = DrawOptions::kLargestFill / 2;

struct Step {
  int x, y;
};

/// The offsets of the largest window, ordered by their distance from its middle.
std::vector<Step> stepsByDistance() {
  std::vector<Step> steps;
  for (int y = -kReach; y <= kReach; ++y)
    for (int x = -kReach; x <= kReach; ++x) steps.push_back({x, y});
  std::stable_sort(steps.begin(), steps.end(),
                   [](const Step& a, const Step& b) { return a.x * a.x + a.y * a.y < b.x * b.x + b.y * b.y; });
  return steps;
}

/// Fills holes from a picture that does not change meanwhile, so that rows may be filled in any order.
class HoleFiller {
 public:
  HoleFiller(const VisibilityBuffer& from, const FillSizes& sizes)
      : from_(from), sizes_(sizes), steps_(stepsByDistance()), width_(static_cast<std::size_t>(from.width)) {}

  void fillRow(int y, PackedPixel* to) const {
    const int top = std::max(y - kReach, 0), bottom = std::min(y + kReach, from_.height - 1);
    // A pixel that is not far behind the front of the largest window is not far behind that of its own smaller one.
    // This settles most pixels cheaply.
    std::vector<PackedPixel> front(width_, kEmptyPixel), columns(width_, kEmptyPixel);
    for (int row = top; row <= bottom; ++row) lowerRow(&from_.pixels[at(0, row)], columns.data(), width_);
    dilateRow(columns.data(), front.data(), width_, DrawOptions::kLargestFill);
    for (int x = 0; x < from_.width; ++x) {
      const PackedPixel own = from_.pixels[at(x, y)];
      const PackedPixel nearest = front[static_cast<std::size_t>(x)];
      to[x] = nearest == kEmptyPixel || !behind(own, nearest) ? own : filled(x, y, own);
    }
  }

 private:
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x); }
  static bool behind(PackedPixel pixel, PackedPixel front) {
    return !(pixelDepth(pixel) <= pixelDepth(front) * DrawOptions::kBlendDepth);
  }

  PackedPixel filled(int x, int y, PackedPixel own) const {
    const int reach = sizes_.at(x, y) / 2;
    const int left = std::max(x - reach, 0), right = std::min(x + reach, from_.width - 1);
    const int top = std::max(y - reach, 0), bottom = std::min(y + reach, from_.height - 1);
    PackedPixel front = kEmptyPixel;
    for (int v = top; v <= bottom; ++v)
      front = std::min(front, *std::min_element(&from_.pixels[at(left, v)], &from_.pixels[at(right, v)] + 1));
    if (front == kEmptyPixel || !behind(own, front)) return own;
    for (const Step& step : steps_) {
      const int u = x + step.x, v = y + step.y;
      if (u < left || u > right || v < top || v > bottom) continue;
      if (!behind(from_.pixels[at(u, v)], front)) return from_.pixels[at(u, v)];
    }
    return own;
  }

  const VisibilityBuffer& from_;
  const FillSizes& sizes_;
  std::vector<Step> steps_;
  std::size_t width_;
};

}  // namespace

FillSizes::FillSizes(const DrawOptions& options, const View& view)
    : least_(std::clamp(options.fill, 1, DrawOptions::kLargestFill) | 1),
      gaze_(options.gaze.on),
      atX_(options.gaze.at.x * static_cast<float>(wholePicture(view).width)),
      atY_(options.gaze.at.y * static_cast<float>(wholePicture(view).height)),
      left_(view.tile.left),
      top_(view.tile.top),
      third_(static_cast<float>(std::max(wholePicture(view).height, 1)) / 3.0f) {}

int FillSizes::at(int x, int y) const {
  if (!gaze_) return least_;
  const float away =
      std::hypot(static_cast<float>(x + left_) + 0.5f - atX_, static_cast<float>(y + top_) + 0.5f - atY_);
  return std::max(least_, away < third_ ? 3 : away < 2.0f * third_ ? 5 : 7);
}

void fillHoles(VisibilityBuffer& buffer, const FillSizes& sizes, const ThreadPool& pool) {
  if (sizes.none() || buffer.pixels.empty()) return;
  resizePixels(buffer.scratch.pixels, buffer.pixels.size());
  const HoleFiller filler(buffer, sizes);
  const auto width = static_cast<std::size_t>(buffer.width);
  pool.parallelFor(static_cast<std::size_t>(buffer.height), kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) filler.fillRow(static_cast<int>(y), &buffer.scratch.pixels[y * width]);
  });
  buffer.pixels.swap(buffer.scratch.pixels);
}

}  // namespace strata
