#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/error.h"

namespace strata {

/// Builds the payload of a journal record.
class RecordWriter {
 public:
  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void put(const T& value) { putBytes(std::as_bytes(std::span(&value, 1))); }
  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void putAll(std::span<const T> values) {
    put<std::uint64_t>(values.size());
    putBytes(std::as_bytes(values));
  }
  void putText(std::string_view text) { putAll(std::span(text.data(), text.size())); }
  /// Writes seven bits per byte, lowest first; the highest bit of a byte says that more follow (LEB128).
  void putShort(std::uint64_t value) {
    for (; value >= 128; value >>= 7) bytes_.push_back(static_cast<std::byte>(value | 128));
    bytes_.push_back(static_cast<std::byte>(value));
  }
  std::size_t size() const { return bytes_.size(); }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  void putBytes(std::span<const std::byte> more) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + more.size());
    if (!more.empty()) std::memcpy(bytes_.data() + at, more.data(), more.size());
  }
  std::vector<std::byte> bytes_;
};

/// Reads the payload of a journal record in the order in which it was written. Throws Error where it ends early.
class RecordReader {
 public:
  explicit RecordReader(std::span<const std::byte> bytes) : all_(bytes), bytes_(bytes) {}

  template <typename T>
  requires std::is_trivially_copyable_v<T> T get() {
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  template <typename T>
  requires std::is_trivially_copyable_v<T> std::vector<T> getAll() {
    const auto count = get<std::uint64_t>();
    if (count > bytes_.size() / sizeof(T)) take(bytes_.size() + 1);
    std::vector<T> values(count);
    const std::span<const std::byte> from = take(count * sizeof(T));
    if (!from.empty()) std::memcpy(values.data(), from.data(), from.size());
    return values;
  }
  std::string getText() {
    const std::vector<char> text = getAll<char>();
    return {text.begin(), text.end()};
  }
  std::uint64_t getShort() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const auto byte = get<std::uint8_t>();
      value |= std::uint64_t{byte & 127u} << shift;
      if (byte < 128) break;
    }
    return value;
  }
  /// Bytes read so far.
  std::size_t position() const { return all_.size() - bytes_.size(); }

 private:
  std::span<const std::byte> take(std::size_t count) {
    if (count > bytes_.size()) throw Error("a record of the journal ends early");
    const std::span<const std::byte> taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  std::span<const std::byte> all_, bytes_;
};

}  // namespace strata
