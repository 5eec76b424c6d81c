#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace strata {

/// The temporary file where points wait between the stages. It has a name, so that an interrupted conversion finds
/// it again; what is no longer needed is punched out of it. All functions are thread-safe; failures throw Error.
class Spill {
 public:
  enum class Open { create, existing };

  /// `path` is created, or has to exist already.
  Spill(std::string path, Open how);
  /// Removes the file unless keep() was called.
  ~Spill();
  Spill(const Spill&) = delete;
  Spill& operator=(const Spill&) = delete;

  void keep() { kept_ = true; }
  /// Removes the file's name now; its points can still be read.
  void discard();
  const std::string& path() const { return path_; }

  /// Appends the bytes, from the start of a page on; returns where they stand.
  std::uint64_t append(std::span<const std::byte> bytes);
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;

  /// Bytes that are kept together and checked when they are read.
  struct Handle {
    std::uint64_t offset = 0, bytes = 0, checksum = 0;
  };
  Handle put(std::span<const std::byte> bytes);
  /// Appends the bytes to `out`.
  void get(const Handle& handle, std::vector<std::byte>& out) const;

  /// Gives the whole pages between the offsets back to the file system. Failing to is harmless.
  void release(std::uint64_t begin, std::uint64_t end);
  /// Forgets everything from `end` on. No other call may run at the same time.
  void truncate(std::uint64_t end);

  /// Most disk held at a time so far, by this process.
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
