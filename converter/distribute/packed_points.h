#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>

namespace strata {

/// How a point travels between the stages: three grid integers of 4 or 8 bytes, then the attribute record.
struct PackedFormat {
  bool wide = false;  ///< 8-byte integers, because the cube spans more than 2^32 steps
  std::size_t attributeBytes = 0;

  std::size_t positionBytes() const { return wide ? 24 : 12; }
  std::size_t stride() const { return positionBytes() + attributeBytes; }

  void putPosition(std::byte* record, const std::int64_t (&grid)[3]) const {
    if (wide) {
      std::memcpy(record, grid, 24);
    } else {
      const std::uint32_t narrow[3] = {static_cast<std::uint32_t>(grid[0]), static_cast<std::uint32_t>(grid[1]),
                                       static_cast<std::uint32_t>(grid[2])};
      std::memcpy(record, narrow, 12);
    }
  }
  void getPosition(const std::byte* record, std::int64_t (&grid)[3]) const {
    if (wide) {
      std::memcpy(grid, record, 24);
    } else {
      std::uint32_t narrow[3];
      std::memcpy(narrow, record, 12);
      for (int axis = 0; axis < 3; ++axis) grid[axis] = narrow[axis];
    }
  }
};

}  // namespace strata
