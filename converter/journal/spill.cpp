#include "converter/journal/spill.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "core/error.h"
#include "io/file/checksum.h"
#include "io/file/positional_io.h"

namespace strata {
namespace {

constexpr std::uint64_t kPage = 4096;

std::uint64_t pageUp(std::uint64_t offset) { return (offset + kPage - 1) / kPage * kPage; }
std::uint64_t pageDown(std::uint64_t offset) { return offset / kPage * kPage; }

}  // namespace

Spill::Spill(std::string path, Open how) : path_(std::move(path)) {
  const int creating = how == Open::create ? O_CREAT | O_EXCL : 0;
  descriptor_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC | creating, 0600);
  if (descriptor_ < 0 && how == Open::existing && errno == ENOENT)
    throw Error(path_, "the temporary points of the interrupted conversion are gone; --force starts it again");
  if (descriptor_ < 0) throw posixError(path_, "creating", errno);
  struct stat status {};
  if (::fstat(descriptor_, &status) == 0) end_ = pageUp(static_cast<std::uint64_t>(status.st_size));
  notePeak();
}

Spill::~Spill() {
  ::close(descriptor_);
  if (!kept_) ::unlink(path_.c_str());
}

void Spill::discard() {
  ::unlink(path_.c_str());
  kept_ = true;  // nothing is left to remove
}

std::uint64_t Spill::append(std::span<const std::byte> bytes) {
  const std::uint64_t start = end_.fetch_add(pageUp(bytes.size()));
  writeAt(descriptor_, path_, start, bytes, "writing temporary points");
  notePeak();
  return start;
}

void Spill::notePeak() {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) return;
  const std::uint64_t held = static_cast<std::uint64_t>(status.st_blocks) * 512;
  for (std::uint64_t peak = peakBytes_; held > peak && !peakBytes_.compare_exchange_weak(peak, held);) {
  }
}

void Spill::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  if (readAt(descriptor_, path_, offset, bytes, "reading temporary points") < bytes.size())
    throw Error(path_, "temporary points end early");
}

SpilledBytes Spill::put(std::span<const std::byte> bytes) { return {append(bytes), bytes.size(), checksum(bytes)}; }

void Spill::get(const SpilledBytes& spilled, std::vector<std::byte>& out) const {
  const std::size_t start = out.size();
  out.resize(start + spilled.bytes);
  read(spilled.offset, std::span(out).subspan(start));
  if (checksum(std::span(out).subspan(start)) != spilled.checksum)
    throw Error(path_, "temporary points are damaged; --force starts the conversion again");
}

void Spill::release(std::uint64_t begin, std::uint64_t end) {
  begin = pageUp(begin);
  end = pageDown(end);
  if (end <= begin) return;
  (void)::fallocate(descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(begin),
                    static_cast<off_t>(end - begin));
}

void Spill::truncate(std::uint64_t end) {
  if (::ftruncate(descriptor_, static_cast<off_t>(end)) != 0) throw posixError(path_, "truncating", errno);
  end_ = pageUp(end);
}

}  // namespace strata
