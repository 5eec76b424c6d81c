#include "render/gl/gl_functions.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"

namespace strata {

GlFunctions loadGlFunctions(GlContext& context) {
  GlFunctions functions;
  const char* missing = nullptr;
  const auto load = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(context.getProc(name));
    const bool newer = std::strcmp(name, "glClipControl") == 0 || std::strcmp(name, "glBufferStorage") == 0;
    if (function == nullptr && !newer) missing = name;
  };
#define STRATA_GL_LOAD(result, name, parameters) load(functions.name, "gl" #name);
  STRATA_GL_FUNCTIONS(STRATA_GL_LOAD)
#undef STRATA_GL_LOAD
  if (missing != nullptr) throw Error("OpenGL", std::string("function is missing, found no ") + missing);
  int major = 0, minor = 0;
  functions.GetIntegerv(gl::kMajorVersion, &major);
  functions.GetIntegerv(gl::kMinorVersion, &minor);
  if (major * 10 + minor < 43)
    throw Error("OpenGL", "version is too old, found " + std::to_string(major) + "." + std::to_string(minor) +
                              " (expected 4.3 or newer)");
  return functions;
}

bool hasExtension(const GlFunctions& functions, std::string_view name) {
  int count = 0;
  functions.GetIntegerv(gl::kExtensionCount, &count);
  for (int i = 0; i < count; ++i) {
    const unsigned char* text = functions.GetStringi(gl::kExtensions, static_cast<unsigned>(i));
    if (text != nullptr && name == reinterpret_cast<const char*>(text)) return true;
  }
  return false;
}

std::uint64_t largestStorageBlock(const GlFunctions& functions) {
  long long bytes = 0;
  functions.GetInteger64v(gl::kMaxShaderStorageBlockSize, &bytes);
  return static_cast<std::uint64_t>(std::max(bytes, 0LL));
}

std::string glRenderer(const GlFunctions& functions) {
  const auto text = [&](unsigned name) {
    const unsigned char* found = functions.GetString(name);
    return std::string(found == nullptr ? "unknown" : reinterpret_cast<const char*>(found));
  };
  return text(gl::kRenderer) + ", driver " + text(gl::kVersion);
}

bool isSoftwareRenderer(const std::string& renderer) {
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "Software Rasterizer", "SwiftShader"})
    if (renderer.find(name) != std::string::npos) return true;
  return false;
}

}  // namespace strata
