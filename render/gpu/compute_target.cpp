#include "render/gpu/compute_target.h"

#include <algorithm>

namespace strata {

ComputeTarget::ComputeTarget(const GlFunctions& functions, ComputeWay way)
    : gl_(functions),
      wide_(way == ComputeWay::compute64),
      locked_(way == ComputeWay::computeLock),
      depths_(functions, 0, gl::kDynamicCopy),
      ids_(functions, 0, gl::kDynamicCopy),
      locks_(functions, 0, gl::kDynamicCopy),
      candidates_(functions, 0, gl::kDynamicCopy),
      sums_(functions, 0, gl::kDynamicCopy),
      largestBlock_(largestStorageBlock(functions)) {}

std::vector<Band> ComputeTarget::begin(std::span<const VisibilityBuffer> views, bool sums, bool counts) {
  hasSums_ = sums;
  hasCounts_ = counts;
  widths_.clear();
  heights_.clear();
  std::uint64_t row = 0;
  int rows = 0;
  for (const VisibilityBuffer& view : views) {
    widths_.push_back(view.width);
    heights_.push_back(view.height);
    row += static_cast<std::uint64_t>(view.width);
    if (view.width > 0) rows = std::max(rows, view.height);
  }
  const std::uint64_t pixelBytes = sums ? sizeof(ColourSum) : wide_ ? sizeof(PackedPixel) : sizeof(std::uint32_t);
  const std::uint64_t fit = largestBlock_ / (std::max<std::uint64_t>(row, 1) * pixelBytes);
  const int atOnce = static_cast<int>(std::clamp<std::uint64_t>(fit, 1, std::uint64_t{1} << 30));
  std::vector<Band> bands;
  for (int first = 0; first < rows; first += atOnce) bands.push_back({first, std::min(first + atOnce, rows)});
  return bands;
}

void ComputeTarget::beginBand(const Band& band) {
  rows_.clear();
  pixels_ = 0;
  for (std::size_t v = 0; v < widths_.size(); ++v) {
    ViewRows rows{pixels_, std::min(band.first, heights_[v]), std::min(band.end, heights_[v]), 0};
    rows.count = static_cast<std::size_t>(rows.end - rows.begin) * static_cast<std::size_t>(widths_[v]);
    pixels_ += rows.count;
    rows_.push_back(rows);
  }
  const auto farthest = static_cast<std::uint32_t>(kEmptyPixel >> 32);
  const std::uint64_t words = std::max<std::uint64_t>(pixels_, 1) * sizeof(std::uint32_t);
  depths_.reserve(wide_ ? 2 * words : words);
  if (wide_) {
    depths_.fill(Picture::kNoPoint, farthest);
  } else {
    ids_.reserve(words);
    depths_.fill(farthest);
    ids_.fill(Picture::kNoPoint);
    ids_.bindStorage(STRATA_BINDING_ID);
  }
  depths_.bindStorage(STRATA_BINDING_DEPTH);
  if (locked_) {
    locks_.reserve(words);
    locks_.fill(0);
    locks_.bindStorage(STRATA_BINDING_MORE);
  }
}

void ComputeTarget::beginRepair(std::uint64_t candidateWords) {
  ids_.fill(Picture::kNoPoint);
  bindCandidates(candidateWords);
}

void ComputeTarget::bindCandidates(std::uint64_t words) {
  candidates_.reserve(std::max<std::uint64_t>(words, 1) * sizeof(std::uint32_t));
  candidates_.bindStorage(STRATA_BINDING_MORE);
}

void ComputeTarget::bindSums() {
  sums_.reserve(std::max<std::uint64_t>(pixels_, 1) * (hasSums_ ? sizeof(ColourSum) : sizeof(std::uint32_t)));
  sums_.fill(0);
  sums_.bindStorage(STRATA_BINDING_MORE);
}

void ComputeTarget::setUniforms() const {
  std::vector<glm::ivec3> uniforms;
  for (const ViewRows& rows : rows_) uniforms.emplace_back(static_cast<int>(rows.first), rows.begin, rows.end);
  gl_.Uniform3iv(STRATA_UNIFORM_PIXELS, static_cast<int>(uniforms.size()), &uniforms[0].x);
}

void ComputeTarget::read(std::span<VisibilityBuffer> views) {
  for (std::size_t v = 0; v < views.size(); ++v) {
    const ViewRows& rows = rows_[v];
    if (rows.count == 0) continue;
    VisibilityBuffer& view = views[v];
    const std::size_t at = static_cast<std::size_t>(rows.begin) * static_cast<std::size_t>(view.width);
    if (wide_) {
      depths_.read(rows.first * sizeof(PackedPixel), &view.pixels[at], rows.count * sizeof(PackedPixel));
    } else {
      hostDepths_.resize(rows.count);
      hostIds_.resize(rows.count);
      depths_.read(rows.first * 4, hostDepths_.data(), rows.count * 4);
      ids_.read(rows.first * 4, hostIds_.data(), rows.count * 4);
      for (std::size_t i = 0; i < rows.count; ++i) view.pixels[at + i] = packPixel(hostDepths_[i], hostIds_[i]);
    }
    if (hasSums_) sums_.read(rows.first * sizeof(ColourSum), &view.sums[at], rows.count * sizeof(ColourSum));
    if (hasCounts_) sums_.read(rows.first * 4, &view.counts[at], rows.count * 4);
  }
}

}  // namespace strata
