#include "render/gl/gl_objects.h"

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "core/error.h"

namespace strata {
namespace {

/// File i of a stage gets the line numbers from i times this on. The source number of `#line` would be the obvious way,
/// but not every compiler repeats it in its messages.
constexpr std::size_t kLinesOfAFile = 10000;

std::ptrdiff_t signedSize(std::uint64_t bytes) { return static_cast<std::ptrdiff_t>(bytes); }

std::string trimmed(std::string text) {
  while (!text.empty() && (text.back() == '\0' || text.back() == '\n')) text.pop_back();
  return text;
}

/// Compiles one stage. Throws Error with the compiler's messages where it fails.
void compile(const GlFunctions& gl, unsigned shader, const ShaderStage& stage) {
  const std::vector<std::string_view>& files = stage.files;
  std::string text = "#version " + std::to_string(stage.version) + " core\n" + stage.preamble;
  for (std::size_t i = 0; i < files.size(); ++i) {
    text += "#line " + std::to_string(i * kLinesOfAFile + 1) + "\n";
    text += shaderText(files[i]);
  }
  const char* begin = text.c_str();
  gl.ShaderSource(shader, 1, &begin, nullptr);
  gl.CompileShader(shader);
  int compiled = 0, length = 0;
  gl.GetShaderiv(shader, gl::kCompileStatus, &compiled);
  if (compiled != 0) return;
  gl.GetShaderiv(shader, gl::kInfoLogLength, &length);
  std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
  gl.GetShaderInfoLog(shader, length, nullptr, log.data());
  throw Error(std::string(files.back()), "shader does not compile:\n" + nameShaderFiles(trimmed(log), files));
}

}  // namespace

GlBuffer::GlBuffer(const GlFunctions& functions, std::uint64_t bytes, unsigned usage) : gl_(functions), usage_(usage) {
  gl_.GenBuffers(1, &name_);
  assign(nullptr, bytes);
}

GlBuffer::~GlBuffer() { gl_.DeleteBuffers(1, &name_); }

void GlBuffer::assign(const void* data, std::uint64_t bytes) {
  bytes_ = bytes;
  gl_.BindBuffer(gl::kShaderStorageBuffer, name_);
  gl_.BufferData(gl::kShaderStorageBuffer, signedSize(bytes), data, usage_);
}

void GlBuffer::write(std::uint64_t offset, const void* data, std::uint64_t bytes) {
  gl_.BindBuffer(gl::kShaderStorageBuffer, name_);
  gl_.BufferSubData(gl::kShaderStorageBuffer, signedSize(offset), signedSize(bytes), data);
}

void GlBuffer::read(std::uint64_t offset, void* data, std::uint64_t bytes) const {
  gl_.BindBuffer(gl::kShaderStorageBuffer, name_);
  gl_.GetBufferSubData(gl::kShaderStorageBuffer, signedSize(offset), signedSize(bytes), data);
}

void GlBuffer::fill(std::uint32_t word) {
  gl_.BindBuffer(gl::kShaderStorageBuffer, name_);
  gl_.ClearBufferData(gl::kShaderStorageBuffer, gl::kR32Ui, gl::kRedInteger, gl::kUnsignedInt, &word);
}

void GlBuffer::fill(std::uint32_t lower, std::uint32_t upper) {
  const std::uint32_t pair[2] = {lower, upper};
  gl_.BindBuffer(gl::kShaderStorageBuffer, name_);
  gl_.ClearBufferData(gl::kShaderStorageBuffer, gl::kRg32Ui, gl::kRgInteger, gl::kUnsignedInt, pair);
}

void GlBuffer::reserve(std::uint64_t bytes) {
  if (bytes_ < bytes) assign(nullptr, bytes);
}

void GlBuffer::bindStorage(unsigned binding) const { gl_.BindBufferBase(gl::kShaderStorageBuffer, binding, name_); }

GlProgram::GlProgram(const GlFunctions& functions, const std::vector<ShaderStage>& stages)
    : gl_(functions), name_(functions.CreateProgram()) {
  try {
    for (const ShaderStage& stage : stages) {
      const unsigned shader = gl_.CreateShader(stage.kind);
      gl_.AttachShader(name_, shader);
      gl_.DeleteShader(shader);  // lives as long as the program it is attached to
      compile(gl_, shader, stage);
    }
    gl_.LinkProgram(name_);
    int linked = 0, length = 0;
    gl_.GetProgramiv(name_, gl::kLinkStatus, &linked);
    if (linked == 0) {
      gl_.GetProgramiv(name_, gl::kInfoLogLength, &length);
      std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
      gl_.GetProgramInfoLog(name_, length, nullptr, log.data());
      throw Error(std::string(stages.front().files.back()), "shader does not link:\n" + trimmed(log));
    }
  } catch (...) {
    gl_.DeleteProgram(name_);
    throw;
  }
}

GlProgram::~GlProgram() { gl_.DeleteProgram(name_); }

std::uint64_t GlTimestamp::value() const {
  unsigned long long nanoseconds = 0;
  gl_.GetQueryObjectui64v(name_, gl::kQueryResult, &nanoseconds);
  return nanoseconds;
}

std::string nameShaderFiles(const std::string& log, const std::vector<std::string_view>& files) {
  std::istringstream in(log);
  std::string result, line;
  while (std::getline(in, line)) {
    unsigned long source = 0, number = 0;
    int end = 0;
    const bool located = std::sscanf(line.c_str(), "%9lu%*1[:(]%9lu%n", &source, &number, &end) == 2 && end > 0;
    if (located && number / kLinesOfAFile < files.size())
      line = std::string(files[number / kLinesOfAFile]) + ":" + std::to_string(number % kLinesOfAFile) +
             line.substr(static_cast<std::size_t>(end));
    result += (result.empty() ? "" : "\n") + line;
  }
  return result;
}

}  // namespace strata
