#pragma once
#include <cstdint>

namespace strata::synthetic {

/// The ASPRS classes that synthetic points have.
namespace asprs {
inline constexpr std::uint8_t kUnclassified = 1, kGround = 2, kLowVegetation = 3, kHighVegetation = 5, kBuilding = 6,
                              kWater = 9, kRoad = 11;
}  // namespace asprs

}  // namespace strata::synthetic
