#pragma once
#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <span>
#include <utility>

namespace strata {

/// Memory for plain values that is used again and again. It grows, loses its values when it does, and never sets them
/// to zero. Large buffers ask for huge pages, because radix sorts write to a thousand places at once.
template <typename T>
class Buffer {
 public:
  Buffer() = default;
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Buffer() { std::free(data_); }

  /// Makes room for at least `count` values and returns the first `count`. Throws std::bad_alloc.
  std::span<T> room(std::size_t count) {
    if (count > capacity_) grow(count);
    return {data_, count};
  }
  T* data() { return data_; }
  const T* data() const { return data_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  void swap(Buffer& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(capacity_, other.capacity_);
  }

 private:
  static constexpr std::size_t kHugePage = std::size_t{2} << 20;

  void grow(std::size_t count) {
    std::free(data_);
    data_ = nullptr;
    capacity_ = 0;
    std::size_t bytes = count * sizeof(T);
    const bool huge = bytes >= 2 * kHugePage;
    const std::size_t unit = huge ? kHugePage : 64;
    bytes = (bytes + unit - 1) / unit * unit;
    data_ = static_cast<T*>(std::aligned_alloc(unit, bytes));
    if (data_ == nullptr) throw std::bad_alloc();
    if (huge) ::madvise(data_, bytes, MADV_HUGEPAGE);  // a wish; it may fail
    capacity_ = count;
  }

  T* data_ = nullptr;
  std::size_t capacity_ = 0;
};

}  // namespace strata
