#pragma once
#include <cstdint>
#include <string>

namespace strata {

/// The machine on which a run was measured.
struct Machine {
  std::string name;          ///< host name
  std::string system;        ///< "Linux 6.1.0 x86_64"
  std::string cpu;           ///< model name
  int cores = 0;             ///< number of cores that this process may use
  std::uint64_t memory = 0;  ///< bytes
};

Machine thisMachine();

/// CPU time used since the machine and the process began, seconds over all cores; zeros when the system does not tell.
struct CpuTime {
  double machine = 0.0, own = 0.0;
};
CpuTime cpuTime();
/// The share of the machine's CPU time that other programs took between two moments `seconds` apart, 0 to 1.
double cpuOfOthers(const CpuTime& from, const CpuTime& to, double seconds);

}  // namespace strata
