#pragma once
#include <string>

#include "core/image.h"

namespace strata {

/// Makes a film of pictures with the program ffmpeg, which runs beside this one and reads them from a socket.
class VideoWriter {
 public:
  /// Starts ffmpeg, which writes H.264 in the container that the ending of `path` names. Throws Error when it is not
  /// installed.
  VideoWriter(const std::string& path, int width, int height, double fps);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// Adds a picture of the size given above. Throws Error when ffmpeg has ended.
  void add(const Image& image);
  /// Waits until the film is written. Throws Error when ffmpeg failed.
  void finish();
  /// Ends ffmpeg at once and leaves the film incomplete.
  void abandon();

 private:
  [[noreturn]] void fail();

  const std::string path_;
  int said_ = -1;  ///< memory file with the messages of ffmpeg on stderr
  int socket_ = -1;
  int process_ = -1;
};

}  // namespace strata
