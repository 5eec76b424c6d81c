#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace strata {

/// The FNV-1a hash of a sequence of values, in 64 bits, which tells whether they have changed. It guards against
/// accidents, not attacks.
class Fingerprint {
 public:
  /// Adds the bytes of a plain value without padding.
  template <typename T>
  void add(const T& value) {
    for (const std::byte byte : std::as_bytes(std::span(&value, 1)))
      hash_ = (hash_ ^ static_cast<std::uint64_t>(byte)) * kPrime;
  }
  std::uint64_t value() const { return hash_; }

 private:
  static constexpr std::uint64_t kOffsetBasis = 0xcbf29ce484222325u, kPrime = 0x100000001b3u;
  std::uint64_t hash_ = kOffsetBasis;
};

}  // namespace strata
