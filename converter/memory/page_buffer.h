#pragma once
#include <cstddef>

namespace strata {

/// Memory straight from the system, in large pages where it has them: taken once, used for many blocks of points.
class PageBuffer {
 public:
  /// Throws std::bad_alloc.
  explicit PageBuffer(std::size_t bytes);
  ~PageBuffer();
  PageBuffer(const PageBuffer&) = delete;
  PageBuffer& operator=(const PageBuffer&) = delete;

  std::byte* data() const { return data_; }
  std::size_t size() const { return bytes_; }

 private:
  std::size_t bytes_;
  std::byte* data_;
};

}  // namespace strata
