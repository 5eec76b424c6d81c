// paper_suites --suite NAME: prints the tables of a paper, measured on this machine.
#include <CLI/CLI.hpp>

#include "core/error.h"
#include "core/program/command_line.h"
#include "core/program/exit_code.h"
#include "tests/bench/suites/suites.h"
#include "viewer/session/picture_size.h"

namespace strata::suite {
namespace {

int run(int argc, char** argv) {
  CLI::App app{"Repeats the experiments of a paper on synthetic scans and prints its tables.", "paper_suites"};
  SuiteOptions options;
  std::string name, backend = "auto", size;
  app.add_option("--suite", name, "the paper: kanzok, schuetz or guenther")
      ->check(CLI::IsMember({"kanzok", "schuetz", "guenther"}))
      ->required();
  app.add_option("--suite-scale", options.scale,
                 "share of the paper's numbers of points; without it, 1 on a GPU and 0.02 otherwise")
      ->check(CLI::Range(1e-6, 10.0));
  app.add_option("--size", size, "size of the pictures, such as 1920x1080; without it, the paper's");
  app.add_option("--backend", backend, backendChoices())->capture_default_str();
  app.add_option("-o,--output", options.folder, "folder in which kanzok leaves its stores and pictures");
  if (!parseCommandLine(app, argc, argv)) return 0;
  options.backend = parseBackend(backend);
  if (!size.empty()) {
    const PictureSize pixels = parseSize(size);
    options.width = pixels.width;
    options.height = pixels.height;
  }
  if (name == "kanzok") runKanzok(options);
  if (name == "schuetz") runSchuetz(options);
  if (name == "guenther") runGuenther(options);
  flushOutput();
  return 0;
}

}  // namespace
}  // namespace strata::suite

int main(int argc, char** argv) { return strata::exitCodeOf(strata::suite::run, argc, argv); }
