#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace strata {

/// Decodes the arithmetic-coded integers of a LAZ chunk table, which have 32 bits and two contexts (Isenburg 2013,
/// "LASzip: lossless compression of LiDAR data", section 4; the coder is that of Said 2004, "Introduction to arithmetic
/// coding").
class LazIntegers {
 public:
  /// `bytes` must outlive the decoder; `file` is the name for errors.
  LazIntegers(std::string file, std::span<const std::byte> bytes);
  ~LazIntegers();

  /// Decodes the next integer, which is coded as a difference to `predicted`. Throws Error when the bytes end or are
  /// damaged.
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
