#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "render/gl/gl_objects.h"

namespace strata {

/// Where words are put together before the GPU copies them to where they stay: a buffer that is mapped once and for all
/// (OpenGL 4.4 or ARB_buffer_storage), gone through as a ring of two halves. A half is written again only when the GPU
/// has copied what stood in it, which by then it nearly always has. Elsewhere, and for what a half cannot hold, plain
/// memory and glBufferSubData.
class GlStaging {
 public:
  /// The ring is made when it is first used.
  GlStaging(const GlFunctions& functions, std::uint64_t halfBytes);
  ~GlStaging();
  GlStaging(const GlStaging&) = delete;
  GlStaging& operator=(const GlStaging&) = delete;

  /// Room for so many words, with any content, to be written and not read; for one send() before the next call.
  std::span<std::uint32_t> room(std::size_t words);
  /// Sends the last room to `to`, from the byte `offset` on.
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
  void* copied_[2] = {nullptr, nullptr};  ///< a fence behind all that is copied out of each half
  int half_ = 0;
  std::uint64_t next_ = 0;  ///< words used of the half
  std::vector<std::uint32_t> plain_;
  std::span<std::uint32_t> room_;
};

}  // namespace strata
