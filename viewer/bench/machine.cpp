#include "viewer/bench/machine.h"

#include <sched.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <fstream>

namespace strata {
namespace {

std::string cpuModel() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

}  // namespace

Machine thisMachine() {
  Machine machine;
  machine.cpu = cpuModel();
  utsname system{};
  if (uname(&system) == 0) {
    machine.name = system.nodename;
    machine.system = std::string(system.sysname) + " " + system.release + " " + system.machine;
  }
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) machine.cores = CPU_COUNT(&allowed);
  const long pages = sysconf(_SC_PHYS_PAGES);
  const long pageBytes = sysconf(_SC_PAGESIZE);
  if (pages > 0 && pageBytes > 0)
    machine.memory = static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(pageBytes);
  return machine;
}

}  // namespace strata
