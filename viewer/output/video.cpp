#include "viewer/output/video.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <vector>

#include "core/error.h"

namespace strata {

VideoWriter::VideoWriter(const std::string& path, int width, int height, double fps) : path_(path) {
  const std::string file = "file:" + path_;  // whatever its name looks like
  const std::string size = std::to_string(width) + "x" + std::to_string(height);
  char rate[32];
  std::snprintf(rate, sizeof rate, "%g", fps);
  // H.264 as most players take it wants even sides: the picture is padded by a row or column where it has to be.
  std::vector<const char*> arguments{"ffmpeg",      "-loglevel",  "error",         "-y",
                                     "-f",          "rawvideo",   "-pixel_format", "rgba",
                                     "-video_size", size.c_str(), "-framerate",    rate,
                                     "-i",          "pipe:0",     "-vf",           "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                     "-c:v",        "libx264",    "-crf",          "18",
                                     "-pix_fmt",    "yuv420p",    "-movflags",     "+faststart",
                                     file.c_str(),  nullptr};
  // A socket, not a pipe: writing to one whose reader has ended can be an error instead of a signal.
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw posixError(path_, "starting ffmpeg", errno);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  said_ = ::memfd_create("ffmpeg", MFD_CLOEXEC);
  if (said_ >= 0) posix_spawn_file_actions_adddup2(&actions, said_, STDERR_FILENO);
  const int failure =
      ::posix_spawnp(&process_, "ffmpeg", &actions, nullptr, const_cast<char**>(arguments.data()), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  socket_ = ends[0];
  if (failure == 0) return;
  ::close(socket_);
  if (said_ >= 0) ::close(said_);
  if (failure == ENOENT) throw Error(path_, "a video needs the program ffmpeg, which is not installed");
  throw posixError(path_, "starting ffmpeg", failure);
}

VideoWriter::~VideoWriter() {
  abandon();
  if (said_ >= 0) ::close(said_);
}

void VideoWriter::abandon() {
  if (socket_ >= 0) ::close(socket_);
  if (process_ > 0) ::waitpid(process_, nullptr, 0);
  socket_ = -1;
  process_ = -1;
}

void VideoWriter::add(const Image& image) {
  const char* bytes = reinterpret_cast<const char*>(image.pixels.data());
  std::size_t left = image.pixels.size() * sizeof(image.pixels[0]);
  while (left > 0) {
    const ssize_t sent = ::send(socket_, bytes, left, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) fail();
    bytes += sent;
    left -= static_cast<std::size_t>(sent);
  }
}

void VideoWriter::finish() {
  ::close(socket_);
  socket_ = -1;
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail();
}

void VideoWriter::fail() {
  abandon();  // its last words are there then
  char text[2000];
  const ssize_t length = said_ >= 0 ? ::pread(said_, text, sizeof text, 0) : 0;
  std::string why(text, static_cast<std::size_t>(std::max<ssize_t>(length, 0)));
  why.erase(std::min(why.find('\n'), why.size()));
  throw Error(path_, "ffmpeg could not write the video" + (why.empty() ? std::string() : ": " + why));
}

}  // namespace strata
