#pragma once
#include <cstdint>
#include <string>

namespace strata {

/// What a figure has to be read with.
struct Machine {
  std::string name;          ///< host name
  std::string system;        ///< "Linux 6.1.0 x86_64"
  std::string cpu;           ///< model name
  int cores = 0;             ///< that this process may use
  std::uint64_t memory = 0;  ///< bytes
};

Machine thisMachine();

}  // namespace strata
