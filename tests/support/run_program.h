#pragma once
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/test_data.h"

namespace strata::test {

/// A program that has ended, and what it printed.
struct Finished {
  int exitCode = -1;  ///< or 128 + the signal that ended it
  std::string out, err;
  double seconds = 0.0;
};

struct RunOptions {
  bool asNobody = false;          ///< run as user and group 65534, which only root can do
  double killAfterSeconds = 0.0;  ///< when the program gets `signal`; 0: never
  int signal = SIGKILL;
};

/// All bytes of a file; empty where it cannot be read.
inline std::string readWhole(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline std::filesystem::path programPath(const std::string& name) { return programFolder() / name; }

/// Runs a program to its end, with nothing on stdin. `program` is the name of one of ours, or a path, which contains a
/// slash.
inline Finished runProgram(const std::string& program, const std::vector<std::string>& arguments,
                           const RunOptions& options = {}) {
  const TempFolder folder;
  const std::string path = program.find('/') == std::string::npos ? programPath(program).string() : program;
  const std::string out = (folder / "out").string();
  const std::string err = (folder / "err").string();
  std::vector<char*> argv{const_cast<char*>(path.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  const auto start = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) {
    const int outFile = open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int errFile = open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
    dup2(outFile, STDOUT_FILENO);
    dup2(errFile, STDERR_FILENO);
    if (options.asNobody && (setgid(65534) != 0 || setuid(65534) != 0)) _exit(126);
    execv(path.c_str(), argv.data());
    _exit(127);
  }
  std::jthread killer;
  if (options.killAfterSeconds > 0.0)
    killer = std::jthread([child, &options](const std::stop_token& stop) {
      std::mutex mutex;
      std::unique_lock lock(mutex);
      std::condition_variable_any ended;
      ended.wait_for(lock, stop, std::chrono::duration<double>(options.killAfterSeconds), [] { return false; });
      if (!stop.stop_requested()) kill(child, options.signal);
    });
  int status = 0;
  if (waitpid(child, &status, 0) != child) throw std::runtime_error("lost " + path);
  Finished finished;
  finished.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  finished.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  finished.out = readWhole(out);
  finished.err = readWhole(err);
  return finished;
}

/// The lines of `text`, without their ends.
inline std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

}  // namespace strata::test
