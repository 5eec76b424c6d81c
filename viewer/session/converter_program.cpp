#include "viewer/session/converter_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "core/error.h"

namespace strata {

std::string converterProgram() {
  namespace fs = std::filesystem;
  std::error_code failure;
  const fs::path self = fs::read_symlink("/proc/self/exe", failure);
  const fs::path converter = self.parent_path() / "strata-convert";
  if (failure || !fs::exists(converter)) throw Error(converter.string(), "the converter is missing");
  return converter.string();
}

void convertToStore(const std::string& input, const std::string& store, const std::vector<std::string>& options) {
  const std::string converter = converterProgram();
  // With --json it writes its progress as lines on stderr, every ten seconds.
  std::vector<std::string> words{"strata-convert", input, "-o", store};
  words.insert(words.end(), options.begin(), options.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t process = -1;
  const int failure = ::posix_spawn(&process, converter.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) throw posixError(converter, "starting", failure);
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw Error(input, "was not converted; the reason stands above");
}

}  // namespace strata
