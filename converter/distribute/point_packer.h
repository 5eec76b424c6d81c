#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "converter/distribute/packed_points.h"
#include "converter/survey/survey.h"
#include "io/scan/point_source.h"

namespace strata {

/// The format that the points of a survey are packed in.
PackedFormat packedFormat(const Survey& survey);

/// Turns the points of one source into packed points on the store's grid. Used by one thread.
class PointPacker {
 public:
  PointPacker(const Survey& survey, const PackedFormat& format, const PointSource& source,
              const SourceMapping& mapping);

  /// Opens one part of the source for read().
  std::unique_ptr<PointReader> open(std::size_t part) const;
  /// Reads at most `maxPoints` more points and packs those that are finite; false at the end of the part. Throws Error.
  bool read(PointReader& reader, std::size_t maxPoints);

  const std::byte* points() const { return packed_.data(); }
  std::size_t count() const { return count_; }      ///< points just packed
  std::size_t skipped() const { return skipped_; }  ///< points just read that are not finite
  bool outside() const { return outside_; }         ///< some of the points just read lie outside the cube

  /// The bounds of the points just packed, in grid integers; meaningless where there are none.
  const std::array<std::uint64_t, 3>& low() const { return low_; }
  const std::array<std::uint64_t, 3>& high() const { return high_; }

 private:
  /// Grid integer = factor * source integer + shift.
  struct IntegerAxis {
    std::int64_t factor = 0, shift = 0;
  };
  bool findIntegerAxes(const PointSource& source);
  template <typename Grid>
  void packIntegers();
  template <typename Grid>
  void packDoubles();
  template <typename Grid>
  void addAttributes();

  const Survey& survey_;
  const PackedFormat format_;
  const PointSource& source_;
  const SourceMapping& mapping_;
  const std::size_t sourceStride_;
  bool integers_ = false;  ///< the source's integers become the store's by IntegerAxis
  std::array<IntegerAxis, 3> axes_{};
  PointBlock block_;
  std::vector<std::uint32_t> kept_;  ///< indices into the block of the points kept; unused where none was skipped
  std::vector<std::byte> packed_;
  std::size_t count_ = 0, skipped_ = 0;
  bool outside_ = false;
  std::array<std::uint64_t, 3> low_{}, high_{};
};

}  // namespace strata
