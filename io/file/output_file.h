#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace strata {

/// A file being written. Every failure throws Error naming the file ("no space left" included); nothing is dropped
/// silently. Not thread-safe, but writeAt of disjoint ranges may run at the same time.
class OutputFile {
 public:
  /// Creates or empties `path`.
  explicit OutputFile(std::string path);
  /// Goes on behind the first `keepBytes` bytes of a file that has at least as many.
  OutputFile(std::string path, std::uint64_t keepBytes);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  void append(std::span<const std::byte> bytes);
  void readAt(std::uint64_t offset, std::span<std::byte> bytes) const;
  void writeAt(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Makes it durable (fsync) and closes it. Without it the destructor only closes.
  void finish();

 private:
  std::string path_;
  int descriptor_;
  std::uint64_t size_ = 0;  ///< bytes appended so far
};

/// Makes the entries of a folder durable after a rename.
void syncFolder(const std::string& path);

}  // namespace strata
