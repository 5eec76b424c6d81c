#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace strata {

/// Bytes in the spill that are kept together and checked when they are read.
struct SpilledBytes {
  std::uint64_t offset = 0, bytes = 0, checksum = 0;
};

/// The temporary file that runs and tops wait in. It has a name, so that a resumed conversion finds it again; what is
/// no longer needed is punched out of it. All functions but truncate() are thread-safe. Failures throw Error.
class Spill {
 public:
  enum class Open { create, existing };

  /// Creates `path`, or opens it where it has to exist.
  Spill(std::string path, Open how);
  /// Removes the file unless keep() was called.
  ~Spill();
  Spill(const Spill&) = delete;
  Spill& operator=(const Spill&) = delete;

  void keep() { kept_ = true; }
  /// Removes the file's name now. The points can still be read.
  void discard();
  const std::string& path() const { return path_; }

  /// Appends the bytes, beginning at the next page of the file, and returns their offset.
  std::uint64_t append(std::span<const std::byte> bytes);
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;

  /// Appends the bytes with a checksum.
  SpilledBytes put(std::span<const std::byte> bytes);
  /// Appends the bytes to `out`.
  void get(const SpilledBytes& spilled, std::vector<std::byte>& out) const;

  /// Gives the whole pages between the offsets back to the file system. Failing to do so is harmless.
  void release(std::uint64_t begin, std::uint64_t end);
  /// Forgets everything from `end` on. No other function may run at the same time.
  void truncate(std::uint64_t end);

  /// The largest size on disk so far in this process.
  std::uint64_t peakBytes() const { return peakBytes_.load(); }

 private:
  void notePeak();

  const std::string path_;
  int descriptor_ = -1;
  std::atomic<bool> kept_{false};
  std::atomic<std::uint64_t> end_{0};
  std::atomic<std::uint64_t> peakBytes_{0};
};

}  // namespace strata
