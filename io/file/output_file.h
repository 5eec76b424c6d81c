#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace strata {

/// A file that is being written. Every failure, a full disk too, throws Error naming the file. One thread at a time may
/// use it, except that several may call writeAt() for ranges that do not overlap.
class OutputFile {
 public:
  /// Creates the file, or empties it.
  explicit OutputFile(std::string path);
  /// Opens a file to go on behind its first `keepBytes` bytes; throws Error when it has fewer.
  OutputFile(std::string path, std::uint64_t keepBytes);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  void append(std::span<const std::byte> bytes);
  /// Fills `bytes` from `offset` on.
  void readAt(std::uint64_t offset, std::span<std::byte> bytes) const;
  void writeAt(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Makes the file durable (fsync) and closes it. A file that is only destroyed is closed but may be lost.
  void finish();

 private:
  std::string path_;
  int descriptor_;
  std::uint64_t size_ = 0;  ///< bytes kept and appended
};

/// Makes the names of the files in a folder durable, after one was renamed.
void syncFolder(const std::string& path);

}  // namespace strata
