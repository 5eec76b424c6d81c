#include "viewer/output/picture_taker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "render/plan/picture_tiles.h"

namespace strata {
namespace {

constexpr int kPartSide = 1024;                             // pixels
constexpr int kLeastPartSide = 64;                          // a part this small is drawn with what memory holds of it
constexpr std::uint64_t kMostOverdrawPixels = 1ull << 24;   // that one frame is drawn of
constexpr std::chrono::milliseconds kLongestWait{120'000};  // for one part's full detail

int partSideOf(const PictureOrder& order) {
  return order.draw.colour == ColourMode::overdraw ? PictureOrder::kLargestSide : kPartSide;
}

SelectionOptions selectionFor(const PictureOrder& order) {
  SelectionOptions selection = order.selection;
  // What a part is drawn with must not depend on what else is in it: no budget, and nothing left out as hidden.
  selection.pointBudget = SelectionOptions::kMaxPointBudget;
  selection.occlusion.enabled = false;
  selection.fadeSeconds = 0.0;
  return selection;
}

}  // namespace

DrawOptions scaledToPicture(const DrawOptions& draw, int fromHeight, int toHeight) {
  DrawOptions scaled = draw;
  const double width = static_cast<double>(draw.pointSize) * toHeight / std::max(fromHeight, 1);
  scaled.pointSize = static_cast<int>(std::clamp(std::round(width), 1.0, double{DrawOptions::kLargestPoint}));
  return scaled;
}

PictureTaker::PictureTaker(PictureOrder order, Layers& layers, Rasterizer& rasterizer)
    : order_(std::move(order)),
      margin_(tileMargin(order_.draw)),
      layers_(layers),
      rasterizer_(rasterizer),
      png_(order_.file, order_.view.width, order_.view.height) {
  if (order_.draw.colour == ColourMode::overdraw &&
      static_cast<std::uint64_t>(order_.view.width) * static_cast<std::uint64_t>(order_.view.height) >
          kMostOverdrawPixels)
    throw Error(order_.file,
                "is too large for an overdraw picture, which is drawn in one piece (expected at most "
                "4096 x 4096 pixels)");
  layers_.setSelection(selectionFor(order_));
  nextRow();
}

/// Empties the row and lays out its parts.
void PictureTaker::nextRow() {
  const int side = partSideOf(order_);
  row_.width = order_.view.width;
  row_.height = std::min(side, order_.view.height - rowTop_);
  row_.pixels.resize(static_cast<std::size_t>(row_.width) * static_cast<std::size_t>(row_.height));
  for (int left = 0; left < row_.width; left += side)
    open_.push_back({left, rowTop_, std::min(side, row_.width - left), row_.height});
  // There and back, so that neighbours follow each other and find their nodes in memory.
  if (rowTop_ / side % 2 == 0) std::reverse(open_.begin(), open_.end());
}

void PictureTaker::split(const Part& part) {
  const int width = (part.width + 1) / 2, height = (part.height + 1) / 2;
  for (int top = part.top; top < part.top + part.height; top += height)
    for (int left = part.left; left < part.left + part.width; left += width)
      open_.push_back(
          {left, top, std::min(width, part.left + part.width - left), std::min(height, part.top + part.height - top)});
}

double PictureTaker::progress() const {
  return static_cast<double>(drawnPixels_) /
         (static_cast<double>(order_.view.width) * static_cast<double>(order_.view.height));
}

bool PictureTaker::goOn(std::chrono::milliseconds patience) {
  const auto now = std::chrono::steady_clock::now();
  const Part part = open_.back();
  const View view = tileOfPicture(order_.view, part.left, part.top, part.width, part.height);
  const View drawn = withMargin(view, margin_);
  if (!asked_) {
    overCapacityBefore_ = layers_.stats().overCapacity;
    layers_.setView(drawn);
    giveUpAt_ = now + kLongestWait;
    asked_ = true;
  }
  const bool complete = layers_.waitUntilComplete(patience);
  if (!complete && now < giveUpAt_) return false;
  asked_ = false;

  const RenderList& list = layers_.beginFrame();
  DrawStats stats;
  do {
    stats = rasterizer_.draw(list, drawn, order_.draw, frame_);
  } while (!isFinished(stats));
  const bool fits = stats.nodesNotUploaded == 0 && layers_.stats().overCapacity == overCapacityBefore_;
  open_.pop_back();
  if (!fits && std::max(part.width, part.height) > kLeastPartSide && order_.draw.colour != ColourMode::overdraw) {
    split(part);
    return false;
  }
  if (!fits || !complete) ++unfinished_;
  copyTile(frame_, drawn, view, row_, {part.left, part.top - rowTop_});
  drawnPixels_ += static_cast<std::uint64_t>(part.width) * static_cast<std::uint64_t>(part.height);
  if (!open_.empty()) return false;

  png_.add(row_.pixels.data(), row_.height);
  rowTop_ += row_.height;
  if (rowTop_ < order_.view.height) {
    nextRow();
    return false;
  }
  png_.finish();
  return true;
}

}  // namespace strata
