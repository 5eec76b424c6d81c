#pragma once
#include <cstddef>
#include <string>
#include <string_view>

#include "render/gl/gl_context.h"

namespace strata {

// Every OpenGL function that Strata calls, as X(return type, name without "gl", parameters). All belong to 4.3 core
// except for ClipControl (4.5 or ARB_clip_control) and BufferStorage (4.4 or ARB_buffer_storage), which may be null.
#define STRATA_GL_FUNCTIONS(X)                                                                                   \
  X(void, ActiveTexture, (unsigned unit))                                                                        \
  X(void, AttachShader, (unsigned program, unsigned shader))                                                     \
  X(void, BindBuffer, (unsigned target, unsigned buffer))                                                        \
  X(void, BindBufferBase, (unsigned target, unsigned index, unsigned buffer))                                    \
  X(void, BindFramebuffer, (unsigned target, unsigned framebuffer))                                              \
  X(void, BindRenderbuffer, (unsigned target, unsigned renderbuffer))                                            \
  X(void, BindVertexArray, (unsigned array))                                                                     \
  X(void, BufferData, (unsigned target, std::ptrdiff_t size, const void* data, unsigned usage))                  \
  X(void, BufferStorage, (unsigned target, std::ptrdiff_t size, const void* data, unsigned flags))               \
  X(void, BufferSubData, (unsigned target, std::ptrdiff_t offset, std::ptrdiff_t size, const void* data))        \
  X(unsigned, CheckFramebufferStatus, (unsigned target))                                                         \
  X(void, ClearBufferData,                                                                                       \
    (unsigned target, unsigned internalFormat, unsigned format, unsigned type, const void* data))                \
  X(void, ClearBufferfv, (unsigned buffer, int index, const float* value))                                       \
  X(void, ClearBufferuiv, (unsigned buffer, int index, const unsigned* value))                                   \
  X(unsigned, ClientWaitSync, (void* sync, unsigned flags, unsigned long long nanoseconds))                      \
  X(void, ClipControl, (unsigned origin, unsigned depth))                                                        \
  X(void, CompileShader, (unsigned shader))                                                                      \
  X(void, CopyBufferSubData,                                                                                     \
    (unsigned from, unsigned to, std::ptrdiff_t fromOffset, std::ptrdiff_t toOffset, std::ptrdiff_t size))       \
  X(unsigned, CreateProgram, ())                                                                                 \
  X(unsigned, CreateShader, (unsigned type))                                                                     \
  X(void, DeleteBuffers, (int count, const unsigned* buffers))                                                   \
  X(void, DeleteFramebuffers, (int count, const unsigned* framebuffers))                                         \
  X(void, DeleteProgram, (unsigned program))                                                                     \
  X(void, DeleteQueries, (int count, const unsigned* queries))                                                   \
  X(void, DeleteRenderbuffers, (int count, const unsigned* renderbuffers))                                       \
  X(void, DeleteShader, (unsigned shader))                                                                       \
  X(void, DeleteSync, (void* sync))                                                                              \
  X(void, DeleteVertexArrays, (int count, const unsigned* arrays))                                               \
  X(void, DepthFunc, (unsigned function))                                                                        \
  X(void, Disable, (unsigned capability))                                                                        \
  X(void, DispatchCompute, (unsigned x, unsigned y, unsigned z))                                                 \
  X(void, DispatchComputeIndirect, (std::ptrdiff_t offset))                                                      \
  X(void, Enable, (unsigned capability))                                                                         \
  X(void, EnableVertexAttribArray, (unsigned index))                                                             \
  X(void*, FenceSync, (unsigned condition, unsigned flags))                                                      \
  X(void, Finish, ())                                                                                            \
  X(void, FramebufferRenderbuffer, (unsigned target, unsigned attachment, unsigned kind, unsigned renderbuffer)) \
  X(void, GenBuffers, (int count, unsigned* buffers))                                                            \
  X(void, GenFramebuffers, (int count, unsigned* framebuffers))                                                  \
  X(void, GenQueries, (int count, unsigned* queries))                                                            \
  X(void, GenRenderbuffers, (int count, unsigned* renderbuffers))                                                \
  X(void, GenVertexArrays, (int count, unsigned* arrays))                                                        \
  X(void, GetBufferSubData, (unsigned target, std::ptrdiff_t offset, std::ptrdiff_t size, void* data))           \
  X(unsigned, GetError, ())                                                                                      \
  X(void, GetInteger64v, (unsigned name, long long* value))                                                      \
  X(void, GetIntegerv, (unsigned name, int* value))                                                              \
  X(void, GetProgramInfoLog, (unsigned program, int capacity, int* length, char* text))                          \
  X(void, GetProgramiv, (unsigned program, unsigned name, int* value))                                           \
  X(void, GetQueryObjectui64v, (unsigned query, unsigned name, unsigned long long* value))                       \
  X(void, GetShaderInfoLog, (unsigned shader, int capacity, int* length, char* text))                            \
  X(void, GetShaderiv, (unsigned shader, unsigned name, int* value))                                             \
  X(const unsigned char*, GetStringi, (unsigned name, unsigned index))                                           \
  X(const unsigned char*, GetString, (unsigned name))                                                            \
  X(void, LinkProgram, (unsigned program))                                                                       \
  X(void*, MapBufferRange, (unsigned target, std::ptrdiff_t offset, std::ptrdiff_t size, unsigned access))       \
  X(void, MemoryBarrier, (unsigned barriers))                                                                    \
  X(void, MultiDrawArraysIndirect, (unsigned mode, const void* commands, int count, int stride))                 \
  X(void, PixelStorei, (unsigned name, int value))                                                               \
  X(void, QueryCounter, (unsigned query, unsigned target))                                                       \
  X(void, ReadBuffer, (unsigned source))                                                                         \
  X(void, ReadPixels, (int x, int y, int width, int height, unsigned format, unsigned type, void* data))         \
  X(void, RenderbufferStorage, (unsigned target, unsigned internalFormat, int width, int height))                \
  X(void, ShaderSource, (unsigned shader, int count, const char* const* texts, const int* lengths))              \
  X(void, Uniform1i, (int location, int x))                                                                      \
  X(void, Uniform1uiv, (int location, int count, const unsigned* values))                                        \
  X(void, Uniform1ui, (int location, unsigned x))                                                                \
  X(void, Uniform2f, (int location, float x, float y))                                                           \
  X(void, Uniform3i, (int location, int x, int y, int z))                                                        \
  X(void, Uniform3iv, (int location, int count, const int* values))                                              \
  X(void, Uniform3ui, (int location, unsigned x, unsigned y, unsigned z))                                        \
  X(void, Uniform4f, (int location, float x, float y, float z, float w))                                         \
  X(void, Uniform4fv, (int location, int count, const float* values))                                            \
  X(void, UseProgram, (unsigned program))                                                                        \
  X(void, VertexAttribDivisor, (unsigned index, unsigned divisor))                                               \
  X(void, VertexAttribIPointer, (unsigned index, int size, unsigned type, int stride, const void* offset))       \
  X(void, Viewport, (int x, int y, int width, int height))

/// The functions of one context. Each context has a table of its own, because EGL and OSMesa give different addresses.
struct GlFunctions {
#define STRATA_GL_MEMBER(result, name, parameters) result(*name) parameters = nullptr;
  STRATA_GL_FUNCTIONS(STRATA_GL_MEMBER)
#undef STRATA_GL_MEMBER
};

/// Values from the OpenGL registry.
namespace gl {
inline constexpr unsigned kPoints = 0x0000;
inline constexpr unsigned kLess = 0x0201;
inline constexpr unsigned kBlend = 0x0BE2;
inline constexpr unsigned kCullFace = 0x0B44;
inline constexpr unsigned kDepthTest = 0x0B71;
inline constexpr unsigned kStencilTest = 0x0B90;
inline constexpr unsigned kScissorTest = 0x0C11;
inline constexpr unsigned kProgramPointSize = 0x8642;
inline constexpr unsigned kPackAlignment = 0x0D05;
inline constexpr unsigned kExtensions = 0x1F03;
inline constexpr unsigned kExtensionCount = 0x821D;
inline constexpr unsigned kMaxTextureSize = 0x0D33;
inline constexpr unsigned kUnsignedInt = 0x1405;
inline constexpr unsigned kFloat = 0x1406;
inline constexpr unsigned kColour = 0x1800;
inline constexpr unsigned kDepth = 0x1801;
inline constexpr unsigned kDepthComponent = 0x1902;
inline constexpr unsigned kRenderer = 0x1F01;
inline constexpr unsigned kVersion = 0x1F02;
inline constexpr unsigned kLowerLeft = 0x8CA1;
inline constexpr unsigned kZeroToOne = 0x935F;
inline constexpr unsigned kNegativeOneToOne = 0x935E;
inline constexpr unsigned kMajorVersion = 0x821B;
inline constexpr unsigned kMinorVersion = 0x821C;
inline constexpr unsigned kRg32Ui = 0x823C;
inline constexpr unsigned kR32Ui = 0x8236;
inline constexpr unsigned kRgInteger = 0x8228;
inline constexpr unsigned kRedInteger = 0x8D94;
inline constexpr unsigned kDepthComponent32F = 0x8CAC;
inline constexpr unsigned kMaxRenderbufferSize = 0x84E8;
inline constexpr unsigned kArrayBuffer = 0x8892;
inline constexpr unsigned kDrawIndirectBuffer = 0x8F3F;
inline constexpr unsigned kDispatchIndirectBuffer = 0x90EE;
inline constexpr unsigned kTimestamp = 0x8E28;
inline constexpr unsigned kQueryResult = 0x8866;
inline constexpr unsigned kShaderStorageBuffer = 0x90D2;
inline constexpr unsigned kMaxShaderStorageBlockSize = 0x90DE;
inline constexpr unsigned kCopyReadBuffer = 0x8F36;
inline constexpr unsigned kCopyWriteBuffer = 0x8F37;
inline constexpr unsigned kMapWrite = 0x0002;
inline constexpr unsigned kMapPersistent = 0x0040;
inline constexpr unsigned kMapCoherent = 0x0080;
inline constexpr unsigned kGpuCommandsComplete = 0x9117;
inline constexpr unsigned kFlushCommands = 0x0001;
inline constexpr unsigned kTimeoutExpired = 0x911B;
inline constexpr unsigned kStreamDraw = 0x88E0;
inline constexpr unsigned kStaticDraw = 0x88E4;
inline constexpr unsigned kDynamicCopy = 0x88EA;
inline constexpr unsigned kFragmentShader = 0x8B30;
inline constexpr unsigned kVertexShader = 0x8B31;
inline constexpr unsigned kComputeShader = 0x91B9;
inline constexpr unsigned kCompileStatus = 0x8B81;
inline constexpr unsigned kLinkStatus = 0x8B82;
inline constexpr unsigned kInfoLogLength = 0x8B84;
inline constexpr unsigned kFramebuffer = 0x8D40;
inline constexpr unsigned kRenderbuffer = 0x8D41;
inline constexpr unsigned kColourAttachment0 = 0x8CE0;
inline constexpr unsigned kDepthAttachment = 0x8D00;
inline constexpr unsigned kFramebufferComplete = 0x8CD5;
inline constexpr unsigned kCommandBarrier = 0x0040;
inline constexpr unsigned kBufferUpdateBarrier = 0x0200;
inline constexpr unsigned kShaderStorageBarrier = 0x2000;
}  // namespace gl

/// The functions of `context`, which is current. Throws Error where it is older than OpenGL 4.3 or lacks a function.
GlFunctions loadGlFunctions(GlContext& context);

bool hasExtension(const GlFunctions& functions, std::string_view name);

/// The largest range of bytes that a shader may see through one binding of a storage buffer.
std::uint64_t largestStorageBlock(const GlFunctions& functions);

/// The device and its driver: "llvmpipe (LLVM 15.0.6, 256 bits), driver 4.5 (Core Profile) Mesa 22.3.6".
std::string glRenderer(const GlFunctions& functions);
/// True where OpenGL runs on the CPU, where the cpu rasterizer is faster.
bool isSoftwareRenderer(const std::string& renderer);

}  // namespace strata
