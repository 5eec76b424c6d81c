#include "converter/journal/disk_room.h"

#include <sys/stat.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <optional>

namespace strata {
namespace {

namespace fs = std::filesystem;

constexpr double kPositionBytes = 12.0;  // of a point between the stages
/// Shares of the packed points that real scans and the synthetic city take (docs/benchmarks.md), the larger of them.
constexpr double kUsualStoreShare = 0.4;
constexpr double kUsualTemporaryShare = 0.6;

/// Free bytes for users like this one.
std::optional<double> roomIn(const std::string& folder) {
  std::error_code failure;
  const fs::space_info space = fs::space(folder, failure);
  if (failure) return std::nullopt;
  return static_cast<double>(space.available);
}

bool sameDisk(const std::string& a, const std::string& b) {
  struct stat one {
  }, other{};
  return ::stat(a.c_str(), &one) == 0 && ::stat(b.c_str(), &other) == 0 && one.st_dev == other.st_dev;
}

std::optional<std::string> warningFor(const std::string& folder, const char* what, double need) {
  const std::optional<double> room = roomIn(folder);
  if (!room || need <= *room) return std::nullopt;
  return folder + ": the disk may be too small for the " + what + ", found " + bytesText(*room) +
         " free (expected about " + bytesText(need) + ")";
}

}  // namespace

DiskNeed usualDiskNeed(const Sources& sources) {
  double packed = 0.0;
  for (const auto& source : sources)
    packed += static_cast<double>(source->info().pointCount) *
              (kPositionBytes + static_cast<double>(source->info().layout.stride()));
  return {kUsualStoreShare * packed, kUsualTemporaryShare * packed};
}

std::vector<std::string> roomWarnings(const std::string& storeFolder, const std::string& tempFolder,
                                      const DiskNeed& need) {
  std::vector<std::string> warnings;
  const auto add = [&](std::optional<std::string> warning) {
    if (warning) warnings.push_back(std::move(*warning));
  };
  if (sameDisk(storeFolder, tempFolder)) {
    add(warningFor(storeFolder, "store and the temporary points", need.store + need.temporary));
  } else {
    add(warningFor(storeFolder, "store", need.store));
    add(warningFor(tempFolder, "temporary points", need.temporary));
  }
  return warnings;
}

std::string folderOf(const std::string& path) {
  const std::string parent = fs::path(path).parent_path().string();
  return parent.empty() ? "." : parent;
}

std::string bytesText(double bytes) {
  constexpr std::array units{"B", "KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  for (; bytes >= 1024.0 && unit + 1 < units.size(); ++unit) bytes /= 1024.0;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), unit == 0 || bytes >= 100.0 ? "%.0f %s" : "%.1f %s", bytes, units[unit]);
  return text.data();
}

}  // namespace strata
