#pragma once
#include "core/image.h"
#include "core/picture.h"
#include "render/gl/gl_context.h"

namespace strata {

/// The OpenGL texture in which a finished picture is shown. Every member needs the window's context to be current.
class PictureTexture {
 public:
  /// Throws Error when a function is missing.
  explicit PictureTexture(GlContext::GetProc getProc);
  ~PictureTexture();
  PictureTexture(const PictureTexture&) = delete;
  PictureTexture& operator=(const PictureTexture&) = delete;

  /// Copies the picture into the texture.
  void upload(const Picture& picture);
  unsigned id() const { return texture_; }
  /// Copies the window's back buffer, row 0 on top.
  Image readBackBuffer(int width, int height) const;

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
