#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace strata {

/// The type of one number in a record: unsigned, signed or floating point, and its bits.
enum class ScalarType : std::uint8_t { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };

/// "u8" to "f64", as store.json has it.
std::string_view scalarName(ScalarType type);
/// The inverse of scalarName(). Throws Error for an unknown name.
ScalarType parseScalarType(std::string_view name);

/// Calls `function` with a zero of the C++ type that `type` names, and returns what it returns.
template <typename Function>
decltype(auto) withScalarType(ScalarType type, Function&& function) {
  switch (type) {
    case ScalarType::u8:
      return function(std::uint8_t{});
    case ScalarType::i8:
      return function(std::int8_t{});
    case ScalarType::u16:
      return function(std::uint16_t{});
    case ScalarType::i16:
      return function(std::int16_t{});
    case ScalarType::u32:
      return function(std::uint32_t{});
    case ScalarType::i32:
      return function(std::int32_t{});
    case ScalarType::u64:
      return function(std::uint64_t{});
    case ScalarType::i64:
      return function(std::int64_t{});
    case ScalarType::f32:
      return function(float{});
    case ScalarType::f64:
      break;
  }
  return function(double{});
}

inline std::size_t scalarBytes(ScalarType type) {
  return withScalarType(type, [](auto value) { return sizeof value; });
}

/// The number of type `type` in the little-endian bytes at `bytes`, which need no alignment, as a double.
inline double loadScalar(const std::byte* bytes, ScalarType type) {
  return withScalarType(type, [bytes](auto value) {
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
  });
}

}  // namespace strata
