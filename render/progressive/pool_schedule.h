#pragma once
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace strata {

/// Decides which places of a pool each frame visits (Rumpler 2019, 3.5.2). His schedule goes round the whole pool. Here
/// the pool is divided into bands, and a turn visits only the bands that the frame shows a point of, or that hold
/// ghosts (points of freed blocks). It visits them in equal shares, and each of their places once.
class PoolSchedule {
 public:
  struct Band {
    std::uint32_t first = 0, end = 0;  ///< places, and also indices, because the shuffle stays within a band
  };
  static constexpr std::uint32_t kBands = 32;
  static constexpr std::uint32_t kLeastBand = 4096;  ///< places of the smallest band

  /// Divides `size` places into at most `bands` bands.
  explicit PoolSchedule(std::uint32_t size, std::uint32_t bands = kBands);

  std::vector<Band> bands() const;
  std::uint32_t bandPlaces() const { return bandPlaces_; }  ///< places of every band except the last

  /// Begins a frame that shows nothing yet. Appends to `slots` those given to freed() that have no ghosts any more.
  void beginFrame(std::vector<std::uint32_t>& slots);
  /// Says that the frame shows the indices [first, first + count); count is at least 1.
  void shown(std::uint32_t first, std::uint32_t count);
  /// Says that the block at these indices was freed. Its points carry `slot`, which must not be a ghost yet.
  void freed(std::uint32_t slot, std::uint32_t first, std::uint32_t count);
  /// For each slot that is a ghost, the number of bands that must still be visited.
  const std::unordered_map<std::uint32_t, std::uint32_t>& ghosts() const { return ghosts_; }

  /// Begins a new turn, because the picture has changed.
  void restart();
  std::uint64_t places() const;   ///< places of a whole turn
  std::uint64_t pending() const;  ///< places that this turn has not visited yet
  /// Visits the next `count` places, at most pending(), and returns them as ranges.
  std::vector<Band> next(std::uint64_t count);

 private:
  struct Ghost {
    std::uint32_t slot;
    std::uint64_t until;  ///< the band is free of these points once `turned` has reached this
  };
  struct BandState {
    Band range;
    std::uint32_t cursor = 0;   ///< the place where the next frame goes on
    std::uint32_t pending = 0;  ///< places not visited in this turn
    std::uint64_t turned = 0;   ///< places visited since the beginning
    bool shown = false;
    std::deque<Ghost> ghosts;  ///< by ascending `until`

    std::uint32_t size() const { return range.end - range.first; }
    bool counts() const { return shown || !ghosts.empty(); }
  };

  std::uint32_t bandPlaces_;
  std::vector<BandState> bands_;
  std::unordered_map<std::uint32_t, std::uint32_t> ghosts_;
};

}  // namespace strata
