#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace strata {

/// Decoder of the arithmetic-coded integers of a LAZ chunk table: 32 bits, two contexts (Isenburg 2013, "LASzip:
/// lossless compression of LiDAR data", section 4; coder after Said 2004, "Introduction to arithmetic coding").
class LazIntegers {
 public:
  /// `bytes` must stay; `file` is named in errors.
  LazIntegers(std::string file, std::span<const std::byte> bytes);
  ~LazIntegers();

  /// The next integer, coded as a difference from `predicted`. Throws Error when the bytes end or make no sense.
  std::uint32_t next(std::uint32_t predicted, int context);

 private:
  struct SymbolModel;
  struct Models;

  std::uint32_t symbol(SymbolModel& model);
  std::uint32_t bit();
  std::uint32_t bits(unsigned count);
  void refill();
  std::uint32_t byte();

  std::string file_;
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::uint32_t value_ = 0;
  std::uint32_t length_ = 0xffffffffu;
  std::unique_ptr<Models> models_;
};

}  // namespace strata
