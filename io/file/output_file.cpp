#include "io/file/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "core/error.h"
#include "io/file/positional_io.h"

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
  if (strata::readAt(descriptor_, path_, offset, bytes) < bytes.size()) throw Error(path_, "ends early");
}

void OutputFile::writeAt(std::uint64_t offset, std::span<const std::byte> bytes) {
  strata::writeAt(descriptor_, path_, offset, bytes);
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
