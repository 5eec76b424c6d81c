#include "render/gl/gl_context.h"

#include "core/error.h"

namespace strata {
namespace {

class AdoptedContext final : public GlContext {
 public:
  explicit AdoptedContext(GetProc source) : source_(source) {}
  void makeCurrent() override {}
  Function getProc(const char* name) override { return source_(name); }

 private:
  GetProc source_;
};

}  // namespace

std::unique_ptr<GlContext> adoptCurrentContext(GlContext::GetProc getProc) {
  return std::make_unique<AdoptedContext>(getProc);
}

std::unique_ptr<GlContext> createHeadlessContext() {
  std::string reasons;
  for (auto* create : {createEglContext, createOsMesaContext}) {
    try {
      return create();
    } catch (const Error& error) {
      reasons += (reasons.empty() ? "" : "; ") + std::string(error.what());
    }
  }
  throw Error("no OpenGL without a window: " + reasons);
}

}  // namespace strata
