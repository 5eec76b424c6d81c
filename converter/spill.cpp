#include "converter/spill.h"

#include <fcntl.h>
#include <lz4.h>
#include <unistd.h>

#include <cerrno>

#include "core/error.h"

namespace strata {
namespace {

constexpr std::uint64_t kPage = 4096;

void writeAll(int descriptor, const std::string& folder, std::span<const std::byte> bytes, std::uint64_t offset) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw posixError(folder, "writing temporary points", errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
}

void readAll(int descriptor, const std::string& folder, std::span<std::byte> bytes, std::uint64_t offset) {
  while (!bytes.empty()) {
    const ssize_t got = ::pread(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw posixError(folder, "reading temporary points", errno);
    if (got == 0) throw Error(folder, "temporary points end early");
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
}

}  // namespace

Spill::Spill(const std::string& folder, std::uint64_t memoryLimit) : folder_(folder), memoryLimit_(memoryLimit) {}

Spill::~Spill() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

int Spill::file() {
  if (descriptor_ >= 0) return descriptor_;
  std::string name = folder_ + "/strata-spill-XXXXXX";
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) throw posixError(folder_, "creating a temporary file", errno);
  ::unlink(name.c_str());
  return descriptor_;
}

Spill::Handle Spill::put(std::span<const std::byte> raw) {
  Handle handle;
  if (raw.size() > LZ4_MAX_INPUT_SIZE) throw Error(folder_, "a block of temporary points is too large for LZ4");
  handle.rawBytes = static_cast<std::uint32_t>(raw.size());
  std::vector<std::byte> packed(static_cast<std::size_t>(LZ4_compressBound(static_cast<int>(raw.size()))));
  const int bytes =
      LZ4_compress_default(reinterpret_cast<const char*>(raw.data()), reinterpret_cast<char*>(packed.data()),
                           static_cast<int>(raw.size()), static_cast<int>(packed.size()));
  packed.resize(static_cast<std::size_t>(bytes));
  handle.storedBytes = static_cast<std::uint32_t>(bytes);
  if (memoryBytes_.fetch_add(packed.size()) + packed.size() <= memoryLimit_) {
    packed.shrink_to_fit();
    handle.memory = std::move(packed);
    return handle;
  }
  memoryBytes_.fetch_sub(packed.size());
  int descriptor;
  {
    const std::lock_guard lock(mutex_);
    descriptor = file();
    handle.offset = fileEnd_;
    fileEnd_ += packed.size();
  }
  writeAll(descriptor, folder_, packed, handle.offset);
  const std::uint64_t held = fileBytes_.fetch_add(packed.size()) + packed.size();
  for (std::uint64_t peak = peakFileBytes_; held > peak && !peakFileBytes_.compare_exchange_weak(peak, held);) {
  }
  return handle;
}

void Spill::clear() {
  if (descriptor_ >= 0 && ::ftruncate(descriptor_, 0) != 0)
    throw posixError(folder_, "emptying temporary points", errno);
  memoryBytes_ = 0;
  fileBytes_ = 0;
  fileEnd_ = 0;
}

void Spill::take(Handle& handle, std::vector<std::byte>& out) {
  const std::size_t start = out.size();
  out.resize(start + handle.rawBytes);
  std::vector<std::byte> packed = std::move(handle.memory);
  handle.memory.clear();
  if (packed.empty()) {
    packed.resize(handle.storedBytes);
    readAll(descriptor_, folder_, packed, handle.offset);
    // Whole pages inside the block go back to the file system at once; failing to is harmless.
    const std::uint64_t first = (handle.offset + kPage - 1) / kPage * kPage;
    const std::uint64_t last = (handle.offset + handle.storedBytes) / kPage * kPage;
    if (last > first)
      (void)::fallocate(descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(first),
                        static_cast<off_t>(last - first));
    fileBytes_.fetch_sub(handle.storedBytes);
  } else {
    memoryBytes_.fetch_sub(packed.size());
  }
  if (LZ4_decompress_safe(reinterpret_cast<const char*>(packed.data()), reinterpret_cast<char*>(out.data() + start),
                          static_cast<int>(packed.size()),
                          static_cast<int>(handle.rawBytes)) != static_cast<int>(handle.rawBytes))
    throw Error(folder_, "temporary points are damaged");
}

}  // namespace strata
