#include "converter/journal/journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "core/error.h"
#include "io/file/checksum.h"
#include "io/file/positional_io.h"

namespace strata {
namespace {

/// The bytes before each payload.
struct Header {
  RecordKind kind;
  std::uint32_t bytes;
  std::uint64_t checksum;  ///< XXH3-64 of the payload, seeded with kind, size and offset
};
static_assert(sizeof(Header) == 16);

constexpr std::array<char, 8> kMagic{'S', 'T', 'R', 'J', 'O', 'U', 'R', '1'};

std::uint64_t sumOf(RecordKind kind, std::uint64_t offset, std::span<const std::byte> payload) {
  const std::uint64_t identity[] = {offset, std::uint64_t{static_cast<std::uint32_t>(kind)}, payload.size()};
  return checksum(payload, checksum(std::as_bytes(std::span(identity))));
}

}  // namespace

Journal::Journal(std::string path) : path_(std::move(path)) {
  descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor_ < 0) throw posixError(path_, "creating", errno);
  std::array<char, 8> magic{};
  readAt(descriptor_, path_, 0, std::as_writable_bytes(std::span(magic)));
  std::uint64_t end = kMagic.size();
  const off_t fileBytes = ::lseek(descriptor_, 0, SEEK_END);
  if (magic == kMagic) {
    Header header{};
    std::vector<std::byte> payload;
    while (readAt(descriptor_, path_, end, std::as_writable_bytes(std::span(&header, 1))) == sizeof header) {
      const std::uint64_t start = end + sizeof header;
      if (start + header.bytes > static_cast<std::uint64_t>(fileBytes)) break;
      payload.resize(header.bytes);
      if (readAt(descriptor_, path_, start, payload) != payload.size() ||
          sumOf(header.kind, start, payload) != header.checksum)
        break;
      found_.push_back({header.kind, start, header.bytes});
      end = start + header.bytes;
    }
  }
  rewind(end);
}

Journal::~Journal() { ::close(descriptor_); }

std::uint64_t Journal::append(RecordKind kind, std::span<const std::byte> payload) {
  if (payload.size() >= UINT32_MAX) throw Error(path_, "a record is too large");
  const MutexLock lock(mutex_);
  const std::uint64_t start = end_ + sizeof(Header);
  const Header header{kind, static_cast<std::uint32_t>(payload.size()), sumOf(kind, start, payload)};
  // The header makes the record count, so it comes last.
  writeAt(descriptor_, path_, start, payload);
  writeAt(descriptor_, path_, end_, std::as_bytes(std::span(&header, 1)));
  end_ = start + payload.size();
  return start;
}

void Journal::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  if (readAt(descriptor_, path_, offset, bytes) != bytes.size()) throw Error(path_, "ends early");
}

std::vector<std::byte> Journal::payload(const FoundRecord& record) const {
  std::vector<std::byte> bytes(record.bytes);
  read(record.offset, bytes);
  return bytes;
}

void Journal::rewind(std::uint64_t end) {
  const MutexLock lock(mutex_);
  while (!found_.empty() && found_.back().offset > end) found_.pop_back();
  end_ = end;
  if (::ftruncate(descriptor_, static_cast<off_t>(end_)) != 0) throw posixError(path_, "truncating", errno);
  writeAt(descriptor_, path_, 0, std::as_bytes(std::span(kMagic)));
}

std::uint64_t Journal::bytes() const {
  const MutexLock lock(mutex_);
  return end_;
}

}  // namespace strata
