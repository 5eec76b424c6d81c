#pragma once
#include <memory>
#include <string>

namespace strata {

/// An OpenGL context, current in the thread that makes it. One thread uses it.
class GlContext {
 public:
  using Function = void (*)();
  using GetProc = Function (*)(const char* name);

  virtual ~GlContext() = default;
  virtual void makeCurrent() = 0;
  /// Returns the address of a GL function, or null where the driver has none.
  virtual Function getProc(const char* name) = 0;
};

/// Makes a context without a window by EGL, on the first device or platform that gives OpenGL 4.3 core. Throws Error
/// where none does.
std::unique_ptr<GlContext> createEglContext();

/// Makes a context of Mesa's off-screen software renderer. Throws Error where the program was built without it or it
/// has no OpenGL 4.3 core.
std::unique_ptr<GlContext> createOsMesaContext();

/// Makes a context without a window by EGL, or else by OSMesa. Throws Error with both reasons where neither works.
std::unique_ptr<GlContext> createHeadlessContext();

/// Wraps a context that the caller has made current and keeps current, such as a window's.
std::unique_ptr<GlContext> adoptCurrentContext(GlContext::GetProc getProc);

}  // namespace strata
