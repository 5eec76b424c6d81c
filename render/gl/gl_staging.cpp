#include "render/gl/gl_staging.h"

namespace strata {
namespace {

constexpr std::uint64_t kAlignedWords = 4;
constexpr std::uint64_t kWaitNanoseconds = 1'000'000'000;

bool hasBufferStorage(const GlFunctions& gl) {
  if (gl.BufferStorage == nullptr) return false;
  int major = 0, minor = 0;
  gl.GetIntegerv(gl::kMajorVersion, &major);
  gl.GetIntegerv(gl::kMinorVersion, &minor);
  return major * 10 + minor >= 44 || hasExtension(gl, "GL_ARB_buffer_storage");
}

}  // namespace

GlStaging::GlStaging(const GlFunctions& functions, std::uint64_t halfBytes)
    : gl_(functions), halfWords_(halfBytes / 4 / kAlignedWords * kAlignedWords), canMap_(hasBufferStorage(functions)) {}

GlStaging::~GlStaging() {
  for (void* fence : copied_)
    if (fence != nullptr) gl_.DeleteSync(fence);
  if (name_ != 0) gl_.DeleteBuffers(1, &name_);  // unmaps it
}

void GlStaging::map() {
  constexpr unsigned kFlags = gl::kMapWrite | gl::kMapPersistent | gl::kMapCoherent;
  const auto bytes = static_cast<std::ptrdiff_t>(2 * halfWords_ * 4);
  gl_.GenBuffers(1, &name_);
  gl_.BindBuffer(gl::kCopyReadBuffer, name_);
  gl_.BufferStorage(gl::kCopyReadBuffer, bytes, nullptr, kFlags);
  mapped_ = static_cast<std::uint32_t*>(gl_.MapBufferRange(gl::kCopyReadBuffer, 0, bytes, kFlags));
  if (mapped_ == nullptr) (void)gl_.GetError();  // takes back the error, which a later check would blame on a page
}

void GlStaging::enterHalf(int half) {
  // The fence lies behind the last copy out of the half that is left now.
  copied_[half_] = gl_.FenceSync(gl::kGpuCommandsComplete, 0);
  half_ = half;
  next_ = 0;
  if (copied_[half] == nullptr) return;
  while (gl_.ClientWaitSync(copied_[half], gl::kFlushCommands, kWaitNanoseconds) == gl::kTimeoutExpired) {
  }
  gl_.DeleteSync(copied_[half]);
  copied_[half] = nullptr;
}

std::span<std::uint32_t> GlStaging::room(std::size_t words) {
  if (canMap_ && name_ == 0) map();
  if (mapped_ == nullptr || words > halfWords_) {
    plain_.resize(words);
    return room_ = plain_;
  }
  if (next_ + words > halfWords_) enterHalf(1 - half_);
  room_ = {mapped_ + static_cast<std::uint64_t>(half_) * halfWords_ + next_, words};
  next_ += (words + kAlignedWords - 1) / kAlignedWords * kAlignedWords;
  return room_;
}

void GlStaging::send(GlBuffer& to, std::uint64_t offset) {
  if (room_.data() == plain_.data()) {
    to.write(offset, room_.data(), room_.size_bytes());
    return;
  }
  gl_.BindBuffer(gl::kCopyReadBuffer, name_);
  gl_.BindBuffer(gl::kCopyWriteBuffer, to.name());
  gl_.CopyBufferSubData(gl::kCopyReadBuffer, gl::kCopyWriteBuffer, (room_.data() - mapped_) * 4,
                        static_cast<std::ptrdiff_t>(offset), static_cast<std::ptrdiff_t>(room_.size_bytes()));
}

}  // namespace strata
