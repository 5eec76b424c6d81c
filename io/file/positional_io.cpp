#include "io/file/positional_io.h"

#include <unistd.h>

#include <cerrno>

#include "core/error.h"

namespace strata {

std::size_t readAt(int descriptor, const std::string& path, std::uint64_t offset, std::span<std::byte> bytes,
                   const char* doing) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got =
        ::pread(descriptor, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw posixError(path, doing, errno);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

void writeAt(int descriptor, const std::string& path, std::uint64_t offset, std::span<const std::byte> bytes,
             const char* doing) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw posixError(path, doing, errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
}

}  // namespace strata
