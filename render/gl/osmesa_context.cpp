#include "core/error.h"
#include "render/gl/gl_context.h"

#ifdef STRATA_OSMESA
#include <GL/osmesa.h>
#endif

namespace strata {

#ifdef STRATA_OSMESA
namespace {

class OsMesaContext final : public GlContext {
 public:
  explicit OsMesaContext(OSMesaContext context) : context_(context) { makeCurrent(); }
  ~OsMesaContext() override { OSMesaDestroyContext(context_); }

  void makeCurrent() override { OSMesaMakeCurrent(context_, pixel_, GL_UNSIGNED_BYTE, 1, 1); }
  Function getProc(const char* name) override { return OSMesaGetProcAddress(name); }

 private:
  OSMesaContext context_;
  unsigned char pixel_[4] = {};  ///< the default framebuffer, which OSMesa insists on; rasterizers draw to their own
};

}  // namespace

std::unique_ptr<GlContext> createOsMesaContext() {
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            4,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  const OSMesaContext context = OSMesaCreateContextAttribs(attributes, nullptr);
  if (context == nullptr) throw Error("OSMesa", "no OpenGL 4.3 core context");
  return std::make_unique<OsMesaContext>(context);
}
#else
std::unique_ptr<GlContext> createOsMesaContext() { throw Error("OSMesa", "this program was built without it"); }
#endif

}  // namespace strata
