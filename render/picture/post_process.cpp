#include "render/picture/post_process.h"

#include <algorithm>
#include <atomic>

#include "render/picture/post_kernel.h"

namespace strata {
namespace {

constexpr std::size_t kRowsAtOnce = 16;
constexpr float kEdlGain = 40.0f;  ///< a depth step of 1 % to all neighbours darkens to about 0.6 at strength 1

}  // namespace

PointSizes::PointSizes(int pixels) : least_(std::clamp(pixels, 1, DrawOptions::kLargestPoint)) {}

PointSizes::PointSizes(const DrawOptions& options, const View& view)
    : least_(std::clamp(options.pointSize, 1, DrawOptions::kLargestPoint)), perspective_(!view.orthographic) {
  if (options.pointMetres <= 0.0f) return;
  View unit = view;
  unit.nearPlane = 0.0;
  pixelsAtUnitDepth_ = static_cast<float>(pixelsAt(unit, static_cast<double>(options.pointMetres), 1.0));
}

namespace {

/// Dilates points of one size, in strips of rows, which stay in the cache between the two directions.
void dilateEvenly(VisibilityBuffer& buffer, std::size_t size, const ThreadPool& pool) {
  const auto width = static_cast<std::size_t>(buffer.width), height = static_cast<std::size_t>(buffer.height);
  resizePixels(buffer.scratch.pixels, buffer.pixels.size());
  pool.parallelFor(height, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    const std::size_t first = begin - std::min(begin, size / 2), last = std::min(end + (size - 1) / 2, height);
    std::vector<PackedPixel> strip((last - first) * width);
    for (std::size_t y = first; y < last; ++y)
      dilateRow(&buffer.pixels[y * width], &strip[(y - first) * width], width, size);
    for (std::size_t y = begin; y < end; ++y) {
      PackedPixel* to = &buffer.scratch.pixels[y * width];
      std::fill_n(to, width, kEmptyPixel);
      for (std::size_t row = y - std::min(y, size / 2); row <= std::min(y + (size - 1) / 2, height - 1); ++row)
        lowerRow(&strip[(row - first) * width], to, width);
    }
  });
  buffer.pixels.swap(buffer.scratch.pixels);
}

}  // namespace

void dilate(VisibilityBuffer& buffer, const PointSizes& sizes, const ThreadPool& pool) {
  if (sizes.alwaysOne() || buffer.pixels.empty()) return;
  if (sizes.even()) return dilateEvenly(buffer, static_cast<std::size_t>(sizes.at(1.0f)), pool);
  const auto width = static_cast<std::size_t>(buffer.width);
  const auto height = static_cast<std::size_t>(buffer.height);
  std::vector<PackedPixel>& rows = buffer.scratch.pixels;
  std::vector<std::uint8_t>& sizeOf = buffer.scratch.sizes;  // of the point in `rows`
  resizePixels(rows, buffer.pixels.size());
  sizeOf.resize(rows.size());
  std::atomic<int> largest{1};
  pool.parallelFor(height, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    int largestHere = 1;
    for (std::size_t y = begin; y < end; ++y) {
      const PackedPixel* from = &buffer.pixels[y * width];
      PackedPixel* to = &rows[y * width];
      std::fill_n(to, width, kEmptyPixel);
      std::fill_n(&sizeOf[y * width], width, std::uint8_t{1});
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
        // A point reaches size / 2 rows down and (size - 1) / 2 rows up; `least` is the size that reaches row y.
        const std::size_t least = row <= y ? 2 * (y - row) : 2 * (row - y) + 1;
        for (std::size_t x = 0; x < width; ++x) to[x] = size[x] >= least ? std::min(to[x], from[x]) : to[x];
      }
    }
  });
}

void eyeDomeLighting(Picture& picture, float strength, const PointSizes& sizes, std::vector<float>& scratch,
                     const ThreadPool& pool) {
  const auto width = static_cast<std::size_t>(picture.width);
  const auto height = static_cast<std::size_t>(picture.height);
  scratch.resize(picture.depth.size());
  pool.parallelFor(height, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    log2Row(picture.depth.data() + begin * width, scratch.data() + begin * width, (end - begin) * width);
  });
  const auto shadeSpan = [&](std::size_t y, std::size_t begin, std::size_t end, int size) {
    const auto apart = static_cast<std::size_t>(size);
    const float* above = &scratch[(y - std::min(y, apart)) * width];
    const float* below = &scratch[std::min(y + apart, height - 1) * width];
    const float gain = kEdlGain / 8.0f * strength / static_cast<float>(size);
    shadeRow({above, &scratch[y * width], below, width, apart}, begin, end, gain, &picture.colour[y * width]);
  };
  pool.parallelFor(height, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      if (sizes.even()) {
        shadeSpan(y, 0, width, sizes.at(1.0f));
        continue;
      }
      for (std::size_t x = 0, next; x < width; x = next) {  // run by run of one size
        const int size = sizes.at(picture.depth[y * width + x]);
        for (next = x + 1; next < width && sizes.at(picture.depth[y * width + next]) == size;) ++next;
        shadeSpan(y, x, next, size);
      }
    }
  });
}

}  // namespace strata
