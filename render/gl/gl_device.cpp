#include "render/gl/gl_device.h"

#include "core/error.h"

namespace strata {
namespace {

std::unique_ptr<GlContext> currentOrThrow(std::unique_ptr<GlContext> context) {
  if (context == nullptr) throw Error("OpenGL", "this way of drawing needs a context, found none");
  context->makeCurrent();
  return context;
}

}  // namespace

GlDevice::GlDevice(std::unique_ptr<GlContext> context)
    : context_(currentOrThrow(std::move(context))),
      gl_(loadGlFunctions(*context_)),
      renderer_(glRenderer(gl_)),
      software_(isSoftwareRenderer(renderer_)) {}

}  // namespace strata
