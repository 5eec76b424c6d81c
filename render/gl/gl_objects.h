#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "render/gl/gl_functions.h"

namespace strata {

// Owners of GL names. `functions` must outlive them, and the context must be current whenever they are used or
// destroyed.

/// A buffer in GPU memory.
class GlBuffer {
 public:
  GlBuffer(const GlFunctions& functions, std::uint64_t bytes, unsigned usage);
  ~GlBuffer();
  GlBuffer(const GlBuffer&) = delete;
  GlBuffer& operator=(const GlBuffer&) = delete;

  unsigned name() const { return name_; }
  std::uint64_t bytes() const { return bytes_; }
  /// Replaces content and size. Null `data` leaves the content undefined.
  void assign(const void* data, std::uint64_t bytes);
  void write(std::uint64_t offset, const void* data, std::uint64_t bytes);
  void read(std::uint64_t offset, void* data, std::uint64_t bytes) const;
  /// Makes the buffer at least `bytes` large. Its content is undefined afterwards.
  void reserve(std::uint64_t bytes);
  /// Sets every 32-bit word.
  void fill(std::uint32_t word);
  /// Sets every pair of 32-bit words, the lower one first.
  void fill(std::uint32_t lower, std::uint32_t upper);
  void bindStorage(unsigned binding) const;

 private:
  const GlFunctions& gl_;
  const unsigned usage_;
  unsigned name_ = 0;
  std::uint64_t bytes_ = 0;
};

/// One stage of a program, and the texts that it is compiled from.
struct ShaderStage {
  unsigned kind;                        ///< gl::kComputeShader, ...
  std::vector<std::string_view> files;  ///< names in render/shaders; compiled as one text, behind version and preamble
  std::string preamble = "";            ///< whole lines: #extension, #define
  int version = 430;                    ///< of GLSL
};

/// A compiled program.
class GlProgram {
 public:
  /// Throws Error where a stage does not compile, with the messages of the compiler, which name file and line.
  GlProgram(const GlFunctions& functions, const std::vector<ShaderStage>& stages);
  ~GlProgram();
  GlProgram(const GlProgram&) = delete;
  GlProgram& operator=(const GlProgram&) = delete;

  void use() const { gl_.UseProgram(name_); }

 private:
  const GlFunctions& gl_;
  unsigned name_ = 0;
};

/// Records when the GPU has finished all commands given before, by its own clock.
class GlTimestamp {
 public:
  explicit GlTimestamp(const GlFunctions& functions) : gl_(functions) { gl_.GenQueries(1, &name_); }
  ~GlTimestamp() { gl_.DeleteQueries(1, &name_); }
  GlTimestamp(const GlTimestamp&) = delete;
  GlTimestamp& operator=(const GlTimestamp&) = delete;

  void record() const { gl_.QueryCounter(name_, gl::kTimestamp); }
  /// Waits for the time of the last record() and returns it, nanoseconds.
  std::uint64_t value() const;

 private:
  const GlFunctions& gl_;
  unsigned name_ = 0;
};

/// Turns the line numbers of a stage's text into file and line, in messages like `0:10020(3): error` or
/// `0(10020) : error`, both of which mean line 20 of the second file.
std::string nameShaderFiles(const std::string& log, const std::vector<std::string_view>& files);

/// The text of a file of render/shaders, which is built into the program. Throws Error for an unknown name.
std::string_view shaderText(std::string_view file);

}  // namespace strata
