#pragma once
#include <string>

#include "core/image.h"

namespace strata {

/// Pictures become a film through the ffmpeg program, which runs beside us and reads them from a socket.
class VideoWriter {
 public:
  /// Starts ffmpeg: H.264 in whatever container the name of `path` asks for. Throws Error when it is not installed.
  VideoWriter(const std::string& path, int width, int height, double fps);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// Of the size given above. Throws Error when ffmpeg has ended.
  void add(const Image& image);
  /// Waits until the film is written. Throws Error when ffmpeg failed.
  void finish();
  /// Ends ffmpeg without more.
  void abandon();

 private:
  [[noreturn]] void fail();

  const std::string path_;
  int said_ = -1;  ///< memory file of what ffmpeg says on stderr
  int socket_ = -1;
  int process_ = -1;
};

}  // namespace strata
