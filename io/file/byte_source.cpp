#include "io/file/byte_source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "core/error.h"
#include "io/file/positional_io.h"

namespace strata {
namespace {

class File final : public ByteSource {
 public:
  explicit File(std::string path) : path_(std::move(path)), descriptor_(::open(path_.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor_ < 0) throw posixError(path_, "opening", errno);
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) {
      const int failure = errno;
      ::close(descriptor_);
      throw posixError(path_, "reading its size", failure);
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~File() override { ::close(descriptor_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  std::uint64_t size() const override { return size_; }
  const std::string& name() const override { return path_; }

  void read(std::uint64_t offset, std::span<std::byte> out) const override {
    const std::size_t got = readAt(descriptor_, path_, offset, out);
    if (got < out.size()) throw Error(path_, "truncated read at byte " + std::to_string(offset + got));
  }

 private:
  std::string path_;
  int descriptor_;
  std::uint64_t size_ = 0;
};

}  // namespace

std::string readBeginning(const ByteSource& bytes, std::uint64_t mostBytes) {
  std::string beginning(static_cast<std::size_t>(std::min(bytes.size(), mostBytes)), '\0');
  bytes.read(0, std::as_writable_bytes(std::span(beginning)));
  return beginning;
}

std::unique_ptr<ByteSource> openFile(const std::string& path) { return std::make_unique<File>(path); }

}  // namespace strata
