#pragma once
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace strata {

/// How the fill pass goes round a pool (Rumpler 2019, 3.5.2), so many places a frame. His goes over all of it, whatever
/// the view shows of it. Here the pool lies in bands, and only those are gone over of which the frame shows a point or
/// that hold ghosts (points of freed blocks), all of them in equal shares: a turn is as long as they are together.
/// Each place of them is met once a turn.
class PoolSchedule {
 public:
  struct Band {
    std::uint32_t first = 0, end = 0;  ///< places, and indices: a permutation stays within its band
  };
  static constexpr std::uint32_t kBands = 32;
  static constexpr std::uint32_t kLeastBand = 4096;  ///< places

  /// One band alone for `bands` 1.
  explicit PoolSchedule(std::uint32_t size, std::uint32_t bands = kBands);

  std::vector<Band> bands() const;
  std::uint32_t bandPlaces() const { return bandPlaces_; }  ///< of each but the last

  /// Nothing is shown of any band. Appends to `slots` those that freed() took and that have no ghosts any more.
  void beginFrame(std::vector<std::uint32_t>& slots);
  /// The frame shows indices [first, first + count), count at least 1.
  void shown(std::uint32_t first, std::uint32_t count);
  /// The block at these indices belongs to nobody now; its points carry `slot`, which is no ghost yet.
  void freed(std::uint32_t slot, std::uint32_t first, std::uint32_t count);
  /// By slot: bands that still have to be gone over.
  const std::unordered_map<std::uint32_t, std::uint32_t>& ghosts() const { return ghosts_; }

  /// The picture is another: all places of the turn are still to be met.
  void restart();
  std::uint64_t places() const;   ///< of a turn
  std::uint64_t pending() const;  ///< of them, those that the picture has not met
  /// The next `count` places, at most pending().
  std::vector<Band> next(std::uint64_t count);

 private:
  struct Ghost {
    std::uint32_t slot;
    std::uint64_t until;  ///< of Round::turned
  };
  struct BandState {
    Band range;
    std::uint32_t cursor = 0;   ///< place at which the next frame goes on
    std::uint32_t pending = 0;  ///< places
    std::uint64_t turned = 0;   ///< places gone over, ever
    bool shown = false;
    std::deque<Ghost> ghosts;  ///< ascending by until

    std::uint32_t size() const { return range.end - range.first; }
    bool counts() const { return shown || !ghosts.empty(); }
  };

  std::uint32_t bandPlaces_;
  std::vector<BandState> bands_;
  std::unordered_map<std::uint32_t, std::uint32_t> ghosts_;
};

}  // namespace strata
