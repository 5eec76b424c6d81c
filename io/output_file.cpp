#include "io/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "core/error.h"

namespace strata {

OutputFile::OutputFile(std::string path)
    : path_(std::move(path)), descriptor_(::open(path_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) throw posixError(path_, "creating", errno);
}

OutputFile::OutputFile(std::string path, std::uint64_t keepBytes)
    : path_(std::move(path)), descriptor_(::open(path_.c_str(), O_RDWR | O_CLOEXEC)), size_(keepBytes) {
  if (descriptor_ < 0) throw posixError(path_, "opening", errno);
  const off_t bytes = ::lseek(descriptor_, 0, SEEK_END);
  const bool whole = bytes >= 0 && static_cast<std::uint64_t>(bytes) >= keepBytes;
  if (whole && ::ftruncate(descriptor_, static_cast<off_t>(keepBytes)) == 0) return;
  const int failure = errno;
  ::close(descriptor_);
  if (!whole)
    throw Error(path_,
                "ends early, found " + std::to_string(bytes) + " bytes (expected " + std::to_string(keepBytes) + ")");
  throw posixError(path_, "truncating", failure);
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void OutputFile::append(std::span<const std::byte> bytes) {
  writeAt(size_, bytes);
  size_ += bytes.size();
}

void OutputFile::readAt(std::uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t got = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw posixError(path_, "reading", errno);
    if (got == 0) throw Error(path_, "ends early");
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
}

void OutputFile::writeAt(std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw posixError(path_, "writing", errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
}

void OutputFile::finish() {
  if (::fsync(descriptor_) != 0) throw posixError(path_, "writing", errno);
  const int closing = std::exchange(descriptor_, -1);
  if (::close(closing) != 0) throw posixError(path_, "closing", errno);
}

void syncFolder(const std::string& path) {
  const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) throw posixError(path, "opening", errno);
  const bool synced = ::fsync(folder) == 0;
  const int failure = errno;
  ::close(folder);
  if (!synced && failure != EINVAL) throw posixError(path, "writing", failure);
}

}  // namespace strata
