#include "tests/support/gl_contexts.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

#include "render/gl/gl_functions.h"

namespace strata::test {
namespace {

/// True where OpenGL is llvmpipe. A process of its own finds out, because Mesa reads the environment once per process.
bool isLlvmpipe() {
  const pid_t child = fork();
  if (child == 0) {
    try {
      const auto context = createHeadlessContext();
      _exit(glRenderer(loadGlFunctions(*context)).find("llvmpipe") != std::string::npos ? 0 : 1);
    } catch (const Error&) {
      _exit(1);
    }
  }
  int status = 1;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

void offerWideAtomicsInSoftware() {
  if (isLlvmpipe()) setenv("MESA_EXTENSION_OVERRIDE", "+GL_NV_shader_atomic_int64", 0);
}

}  // namespace strata::test
