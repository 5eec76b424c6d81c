#include "core/scalar.h"

#include <array>
#include <string>

#include "core/error.h"

namespace strata {
namespace {

/// In the order of ScalarType.
constexpr std::array<std::string_view, 10> kNames{"u8", "i8", "u16", "i16", "u32", "i32", "u64", "i64", "f32", "f64"};

}  // namespace

std::string_view scalarName(ScalarType type) { return kNames.at(static_cast<std::size_t>(type)); }

ScalarType parseScalarType(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return static_cast<ScalarType>(i);
  throw Error("unknown attribute type '" + std::string(name) + "'");
}

}  // namespace strata
