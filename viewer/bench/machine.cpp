#include "viewer/bench/machine.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
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

CpuTime cpuTime() {
  CpuTime time;
  // proc(5): the first line of /proc/stat has user, nice, system, idle, iowait, irq, softirq and steal, in ticks.
  std::ifstream stat("/proc/stat");
  std::string name;
  double ticks[8] = {};
  if (stat >> name >> ticks[0] >> ticks[1] >> ticks[2] >> ticks[3] >> ticks[4] >> ticks[5] >> ticks[6] >> ticks[7])
    time.machine =
        (ticks[0] + ticks[1] + ticks[2] + ticks[5] + ticks[6] + ticks[7]) / static_cast<double>(sysconf(_SC_CLK_TCK));
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0)
    time.own = static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
               1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  return time;
}

double cpuOfOthers(const CpuTime& from, const CpuTime& to, double seconds) {
  const double all = seconds * static_cast<double>(sysconf(_SC_NPROCESSORS_ONLN));
  const double others = (to.machine - from.machine) - (to.own - from.own);
  return all > 0.0 ? std::clamp(others / all, 0.0, 1.0) : 0.0;
}

}  // namespace strata
