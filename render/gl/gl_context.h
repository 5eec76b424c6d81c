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
  /// Address of a GL function, null where the driver has none.
  virtual Function getProc(const char* name) = 0;
};

/// Without a window: EGL on Mesa's surfaceless platform or on the first device that gives OpenGL 4.3 core.
/// Throws Error where none does.
std::unique_ptr<GlContext> createEglContext();

/// Mesa's off-screen software renderer. Throws Error where libOSMesa is absent or has no OpenGL 4.3 core.
std::unique_ptr<GlContext> createOsMesaContext();

/// EGL, else OSMesa. Throws Error with both reasons.
std::unique_ptr<GlContext> createHeadlessContext();

/// The context that the caller has made current and keeps so (a window's).
std::unique_ptr<GlContext> adoptCurrentContext(GlContext::GetProc getProc);

}  // namespace strata
