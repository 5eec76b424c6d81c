#include "render/progressive/pool_schedule.h"

#include <algorithm>

namespace strata {

PoolSchedule::PoolSchedule(std::uint32_t size, std::uint32_t bands)
    : bandPlaces_(std::max({size / bands + (size % bands != 0), std::min(size, kLeastBand), 1u})) {
  for (std::uint32_t first = 0; first < size; first += std::min(bandPlaces_, size - first)) {
    BandState band;
    band.range = {first, first + std::min(bandPlaces_, size - first)};
    band.cursor = first;
    bands_.push_back(std::move(band));
  }
}

std::vector<PoolSchedule::Band> PoolSchedule::bands() const {
  std::vector<Band> bands;
  for (const BandState& band : bands_) bands.push_back(band.range);
  return bands;
}

void PoolSchedule::beginFrame(std::vector<std::uint32_t>& slots) {
  for (BandState& band : bands_) {
    band.shown = false;
    for (; !band.ghosts.empty() && band.ghosts.front().until <= band.turned; band.ghosts.pop_front()) {
      const auto ghost = ghosts_.find(band.ghosts.front().slot);
      if (--ghost->second > 0) continue;
      slots.push_back(ghost->first);
      ghosts_.erase(ghost);
    }
  }
}

void PoolSchedule::shown(std::uint32_t first, std::uint32_t count) {
  for (std::uint32_t i = first / bandPlaces_; i <= (first + count - 1) / bandPlaces_; ++i) bands_[i].shown = true;
}

void PoolSchedule::freed(std::uint32_t slot, std::uint32_t first, std::uint32_t count) {
  const std::uint32_t from = first / bandPlaces_, to = (first + count - 1) / bandPlaces_;
  ghosts_[slot] = to - from + 1;
  for (std::uint32_t i = from; i <= to; ++i) bands_[i].ghosts.push_back({slot, bands_[i].turned + bands_[i].size()});
}

void PoolSchedule::restart() {
  for (BandState& band : bands_) band.pending = band.counts() ? band.size() : 0;
}

std::uint64_t PoolSchedule::places() const {
  std::uint64_t sum = 0;
  for (const BandState& band : bands_) sum += band.counts() ? band.size() : 0;
  return sum;
}

std::uint64_t PoolSchedule::pending() const {
  std::uint64_t sum = 0;
  for (const BandState& band : bands_) sum += band.pending;
  return sum;
}

std::vector<PoolSchedule::Band> PoolSchedule::next(std::uint64_t count) {
  std::vector<BandState*> open;
  for (BandState& band : bands_)
    if (band.pending > 0) open.push_back(&band);
  std::stable_sort(open.begin(), open.end(),
                   [](const BandState* a, const BandState* b) { return a->pending < b->pending; });
  std::vector<Band> ranges;
  for (std::size_t i = 0; i < open.size(); ++i) {  // what one has too few places for is the others'
    BandState& band = *open[i];
    auto share = static_cast<std::uint32_t>(std::min<std::uint64_t>(band.pending, count / (open.size() - i)));
    count -= share;
    band.pending -= share;
    band.turned += share;
    while (share > 0) {
      const std::uint32_t now = std::min(share, band.range.end - band.cursor);
      ranges.push_back({band.cursor, band.cursor + now});
      band.cursor = band.cursor + now == band.range.end ? band.range.first : band.cursor + now;
      share -= now;
    }
  }
  return ranges;
}

}  // namespace strata
