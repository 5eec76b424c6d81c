#include "viewer/bench/page_cache.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <vector>

#include "core/error.h"
#include "core/log.h"

namespace strata {
namespace {

double residentShare(int file, std::size_t bytes) {
  if (bytes == 0) return 0.0;
  void* mapped = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, file, 0);
  if (mapped == MAP_FAILED) return 0.0;
  const std::size_t page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  std::vector<unsigned char> held((bytes + page - 1) / page, 0);
  const bool known = mincore(mapped, bytes, held.data()) == 0;
  munmap(mapped, bytes);
  if (!known) return 0.0;
  const auto count = std::count_if(held.begin(), held.end(), [](unsigned char flags) { return (flags & 1) != 0; });
  return static_cast<double>(count) / static_cast<double>(held.size());
}

}  // namespace

double shareInPageCache(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw posixError(path, "opening", errno);
  struct stat status {};
  const double share = fstat(file, &status) == 0 ? residentShare(file, static_cast<std::size_t>(status.st_size)) : 0.0;
  ::close(file);
  return share;
}

double dropFromPageCache(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw posixError(path, "opening", errno);
  struct stat status {};
  // Pages not written back yet cannot be dropped.
  const bool known = fstat(file, &status) == 0 && fdatasync(file) == 0;
  const int failure = known ? posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED) : errno;
  const double share = failure == 0 ? residentShare(file, static_cast<std::size_t>(status.st_size)) : 1.0;
  ::close(file);
  if (failure != 0) throw posixError(path, "dropping it from the page cache", failure);
  return share;
}

std::string dropPages(const Store& store) {
  char text[80];
  std::snprintf(text, sizeof text, "cold: points.bin dropped (posix_fadvise), %.0f %% stayed",
                100.0 * dropFromPageCache(store.points().name()));
  logInfo(std::string("page cache: ") + text);
  return text;
}

std::string pagesAsTheyAre(const Store& store) {
  char text[80];
  std::snprintf(text, sizeof text, "left as it was: %.0f %% of points.bin in memory at the start",
                100.0 * shareInPageCache(store.points().name()));
  return text;
}

}  // namespace strata
