#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace strata {

/// Random access to bytes. Files of scans and stores are read through it alone, so that tests can put sources in their
/// place that fail, are slow or end early. Any thread may use it at any time.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual std::uint64_t size() const = 0;
  /// Fills `out` with the bytes from `offset` on. Throws Error naming the file when there are too few.
  virtual void read(std::uint64_t offset, std::span<std::byte> out) const = 0;
  virtual const std::string& name() const = 0;
};

/// The first `mostBytes` bytes, or all of a shorter source, as text. Throws as ByteSource::read().
std::string readBeginning(const ByteSource& bytes, std::uint64_t mostBytes);

/// Opens a file, which is read by pread(). Throws Error when it cannot be opened.
std::unique_ptr<ByteSource> openFile(const std::string& path);

}  // namespace strata
