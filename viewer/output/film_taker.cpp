#include "viewer/output/film_taker.h"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "core/error.h"
#include "core/picture.h"

namespace strata {
namespace {

constexpr std::chrono::milliseconds kLongestWait{120'000};  // for one frame's full detail

/// The ending says which container it is.
std::string besideWhileUnfinished(const std::filesystem::path& file) {
  return (file.parent_path() / (file.stem().string() + ".part" + file.extension().string())).string();
}

}  // namespace

FilmTaker::FilmTaker(FilmOrder order, Layers& layers, Rasterizer& rasterizer)
    : order_(std::move(order)),
      clock_(order_.path),
      frames_(order_.path.frames()),
      layers_(layers),
      rasterizer_(rasterizer),
      unfinished_(besideWhileUnfinished(order_.file)),
      video_(unfinished_, order_.width, order_.height, order_.path.fps) {}

FilmTaker::~FilmTaker() {
  if (finished_) return;
  video_.abandon();
  std::remove(unfinished_.c_str());
}

bool FilmTaker::goOn(std::chrono::milliseconds patience) {
  const auto now = std::chrono::steady_clock::now();
  const double t = clock_.keyTime(order_.path.keys.front().t + index_ / order_.path.fps);
  const View view = viewAt(order_.path, t, order_.width, order_.height);
  if (!asked_) {
    layers_.setView(view);
    giveUpAt_ = now + kLongestWait;
    asked_ = true;
  }
  if (!layers_.waitUntilComplete(patience) && now < giveUpAt_) return false;
  asked_ = false;
  const RenderList& list = layers_.beginFrame();
  DrawStats stats;
  do {
    stats = rasterizer_.draw(list, view, order_.draw, frame_);
  } while (!isFinished(stats));
  video_.add(imageOf(frame_));
  if (++index_ < frames_) return false;
  video_.finish();
  if (std::rename(unfinished_.c_str(), order_.file.c_str()) != 0) throw posixError(order_.file, "writing", errno);
  finished_ = true;
  return true;
}

}  // namespace strata
