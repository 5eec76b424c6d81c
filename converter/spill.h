#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace strata {

/// Where blocks of points wait between stages: in memory up to a limit, then LZ4-packed in one temporary file. The
/// file has no name from the moment it is open, so that nothing of it stays after a crash; what has been taken is
/// punched out of it. All functions are thread-safe.
class Spill {
 public:
  struct Handle {
    std::uint64_t offset = 0;  ///< in the file, when `memory` is empty
    std::uint32_t storedBytes = 0;
    std::uint32_t rawBytes = 0;
    std::vector<std::byte> memory;  ///< packed bytes, while they fit
  };

  Spill(const std::string& folder, std::uint64_t memoryLimit);
  ~Spill();
  Spill(const Spill&) = delete;
  Spill& operator=(const Spill&) = delete;

  Handle put(std::span<const std::byte> raw);
  /// Appends the block's bytes to `out` and gives its room back. Throws Error when the disk fails.
  void take(Handle& handle, std::vector<std::byte>& out);

  /// Forgets every block; none may be taken any more. No other call may run at the same time.
  void clear();

  std::uint64_t peakFileBytes() const { return peakFileBytes_.load(); }

 private:
  int file();

  const std::string folder_;
  const std::uint64_t memoryLimit_;
  std::atomic<std::uint64_t> memoryBytes_{0};
  std::atomic<std::uint64_t> fileBytes_{0};  ///< held in the file now
  std::atomic<std::uint64_t> peakFileBytes_{0};
  std::mutex mutex_;
  int descriptor_ = -1;        ///< guarded by mutex_ until open
  std::uint64_t fileEnd_ = 0;  ///< guarded by mutex_
};

}  // namespace strata
