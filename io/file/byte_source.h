#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace strata {

/// Random access to bytes; the only way a store's points are read. Thread-safe. Tests put failing, slow and
/// short sources behind it; stores over HTTP ranges will be another.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual std::uint64_t size() const = 0;
  /// Fills all of `out` from `offset`, or throws Error naming the file.
  virtual void read(std::uint64_t offset, std::span<std::byte> out) const = 0;
  virtual const std::string& name() const = 0;
};

/// The first `mostBytes` bytes, or all of a shorter source, as text. Throws as ByteSource::read().
std::string readBeginning(const ByteSource& bytes, std::uint64_t mostBytes);

/// A file through pread. Throws Error when it cannot be opened.
std::unique_ptr<ByteSource> openFile(const std::string& path);

}  // namespace strata
