#pragma once
#include <cstdint>
#include <string>

namespace strata {

/// A count for people, with three digits: "950", "12.3 k", "4.56 M", "1.20 G".
std::string readableCount(double value);
/// A number of bytes with three digits, in powers of 1000: "12.3 MB".
std::string readableBytes(double bytes);
/// A time with three digits: "8.31 ms", "2.40 s".
std::string readableMs(double ms);
/// All digits of a count in groups of three: "1 234 567".
std::string grouped(std::uint64_t count);

}  // namespace strata
