#include "io/file/text_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

#include "core/error.h"

namespace strata {

std::string readText(const std::string& path, std::size_t mostBytes) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw posixError(path, "opening", EISDIR);
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw posixError(path, "opening", errno != 0 ? errno : EIO);
  std::string text;
  constexpr std::size_t kStep = std::size_t{1} << 16;
  while (file && text.size() <= mostBytes) {
    const std::size_t before = text.size();
    text.resize(before + kStep);
    file.read(text.data() + before, static_cast<std::streamsize>(kStep));
    text.resize(before + static_cast<std::size_t>(file.gcount()));
  }
  if (text.size() > mostBytes)
    throw Error(path, "is too large to be read here, found more than " + std::to_string(mostBytes) + " bytes");
  if (file.bad()) throw Error(path, "cannot be read as a file");
  return text;
}

void writeText(const std::string& path, std::string_view text) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const bool device = fs::exists(path, ignored) && !fs::is_regular_file(path, ignored);
  const fs::path target = device ? fs::path(path) : fs::weakly_canonical(path, ignored);
  const std::string next = device ? path : target.string() + ".part";
  const int file = ::open(next.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) throw posixError(path, "opening for writing", errno);
  int failure = 0;
  while (!text.empty() && failure == 0) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0 && errno != EINTR) failure = errno;
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::close(file) != 0 && failure == 0) failure = errno;
  if (failure == 0 && !device && ::rename(next.c_str(), target.c_str()) != 0) failure = errno;
  if (failure == 0) return;
  if (!device) ::unlink(next.c_str());
  throw posixError(path, "writing", failure);
}

void makeFolder(const std::string& path) {
  std::error_code failure;
  std::filesystem::create_directories(path, failure);
  if (failure) throw Error(path, "making the folder: " + failure.message());
}

}  // namespace strata
