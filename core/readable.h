#pragma once
#include <string>

namespace strata {

/// "950", "12.3 k", "4.56 M", "1.20 G": three digits that a person reads.
std::string readableCount(double value);
/// "12.3 MB" in powers of 1000.
std::string readableBytes(double bytes);
/// "8.31 ms", "2.40 s".
std::string readableMs(double ms);

}  // namespace strata
