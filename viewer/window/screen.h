#pragma once
#include "core/image.h"
#include "core/picture.h"
#include "render/gl/gl_context.h"

namespace strata {

/// The little OpenGL that showing a finished frame takes. The window's context is current wherever this is used.
class Screen {
 public:
  /// Throws Error when a function is missing.
  explicit Screen(GlContext::GetProc getProc);
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// Copies the picture into the texture, row 0 first.
  void upload(const Picture& frame);
  unsigned texture() const { return texture_; }
  /// What stands in the back buffer.
  Image read(int width, int height) const;

 private:
  struct Functions {
    void (*genTextures)(int, unsigned*) = nullptr;
    void (*deleteTextures)(int, const unsigned*) = nullptr;
    void (*bindTexture)(unsigned, unsigned) = nullptr;
    void (*texParameteri)(unsigned, unsigned, int) = nullptr;
    void (*texImage2D)(unsigned, int, int, int, int, int, unsigned, unsigned, const void*) = nullptr;
    void (*texSubImage2D)(unsigned, int, int, int, int, int, unsigned, unsigned, const void*) = nullptr;
    void (*pixelStorei)(unsigned, int) = nullptr;
    void (*readPixels)(int, int, int, int, unsigned, unsigned, void*) = nullptr;
  };

  Functions gl_;
  unsigned texture_ = 0;
  int width_ = 0, height_ = 0;
};

}  // namespace strata
