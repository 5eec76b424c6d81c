#include "render/progressive/pool_schedule.h"

#include <algorithm>

namespace strata {

PoolTurn::PoolTurn(std::uint32_t size, std::uint32_t bands)
    : bandPlaces_(std::max({size / bands + (size % bands != 0), std::min(size, kLeastBand), 1u})) {
  for (std::uint32_t first = 0; first < size; first += std::min(bandPlaces_, size - first)) {
    Round round;
    round.band = {first, first + std::min(bandPlaces_, size - first)};
    round.cursor = first;
    rounds_.push_back(std::move(round));
  }
}

std::vector<PoolTurn::Band> PoolTurn::bands() const {
  std::vector<Band> bands;
  for (const Round& round : rounds_) bands.push_back(round.band);
  return bands;
}

void PoolTurn::beginFrame(std::vector<std::uint32_t>& slots) {
  for (Round& round : rounds_) {
    round.shown = false;
    for (; !round.ghosts.empty() && round.ghosts.front().until <= round.turned; round.ghosts.pop_front()) {
      const auto ghost = ghosts_.find(round.ghosts.front().slot);
      if (--ghost->second > 0) continue;
      slots.push_back(ghost->first);
      ghosts_.erase(ghost);
    }
  }
}

void PoolTurn::shown(std::uint32_t first, std::uint32_t count) {
  for (std::uint32_t band = first / bandPlaces_; band <= (first + count - 1) / bandPlaces_; ++band)
    rounds_[band].shown = true;
}

void PoolTurn::freed(std::uint32_t slot, std::uint32_t first, std::uint32_t count) {
  const std::uint32_t from = first / bandPlaces_, to = (first + count - 1) / bandPlaces_;
  ghosts_[slot] = to - from + 1;
  for (std::uint32_t band = from; band <= to; ++band)
    rounds_[band].ghosts.push_back({slot, rounds_[band].turned + rounds_[band].size()});
}

void PoolTurn::restart() {
  for (Round& round : rounds_) round.pending = round.counts() ? round.size() : 0;
}

std::uint64_t PoolTurn::places() const {
  std::uint64_t sum = 0;
  for (const Round& round : rounds_) sum += round.counts() ? round.size() : 0;
  return sum;
}

std::uint64_t PoolTurn::pending() const {
  std::uint64_t sum = 0;
  for (const Round& round : rounds_) sum += round.pending;
  return sum;
}

std::vector<PoolTurn::Band> PoolTurn::next(std::uint64_t count) {
  std::vector<Round*> open;
  for (Round& round : rounds_)
    if (round.pending > 0) open.push_back(&round);
  std::stable_sort(open.begin(), open.end(), [](const Round* a, const Round* b) { return a->pending < b->pending; });
  std::vector<Band> ranges;
  for (std::size_t i = 0; i < open.size(); ++i) {  // what one has too few places for is the others'
    Round& round = *open[i];
    auto share = static_cast<std::uint32_t>(std::min<std::uint64_t>(round.pending, count / (open.size() - i)));
    count -= share;
    round.pending -= share;
    round.turned += share;
    while (share > 0) {
      const std::uint32_t now = std::min(share, round.band.end - round.cursor);
      ranges.push_back({round.cursor, round.cursor + now});
      round.cursor = round.cursor + now == round.band.end ? round.band.first : round.cursor + now;
      share -= now;
    }
  }
  return ranges;
}

}  // namespace strata
