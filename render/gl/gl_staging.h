#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "render/gl/gl_objects.h"

namespace strata {

/// Memory in which data is assembled before the GPU copies it to its buffer. It is a ring of two halves that stay
/// mapped (OpenGL 4.4 or ARB_buffer_storage). A half is written again only after the GPU has copied its content, which
/// is nearly always the case by then. Without that extension, and for what is larger than a half, it is plain memory
/// and glBufferSubData.
class GlStaging {
 public:
  /// The ring, of two halves of `halfBytes` bytes, is made when it is first used.
  GlStaging(const GlFunctions& functions, std::uint64_t halfBytes);
  ~GlStaging();
  GlStaging(const GlStaging&) = delete;
  GlStaging& operator=(const GlStaging&) = delete;

  /// Returns room for `words` words of undefined content, which may be written but not read. It is valid for one send()
  /// and until the next call.
  std::span<std::uint32_t> room(std::size_t words);
  /// Copies the last room to `to`, from byte `offset` on.
  void send(GlBuffer& to, std::uint64_t offset);

  bool isMapped() const { return mapped_ != nullptr; }

 private:
  void map();
  void enterHalf(int half);

  const GlFunctions& gl_;
  const std::uint64_t halfWords_;
  const bool canMap_;
  unsigned name_ = 0;
  std::uint32_t* mapped_ = nullptr;
  void* copied_[2] = {nullptr, nullptr};  ///< for each half a fence behind the last copy out of it
  int half_ = 0;
  std::uint64_t next_ = 0;  ///< words used of the half
  std::vector<std::uint32_t> plain_;
  std::span<std::uint32_t> room_;
};

}  // namespace strata
