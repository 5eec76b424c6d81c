#include "viewer/bench/suite.h"

#include "core/error.h"
#include "viewer/bench/suite_parts.h"

namespace strata {

void runSuite(const SuiteOptions& options) {
  if (options.name == "kanzok") return suite::runKanzok(options);
  if (options.name == "schuetz") return suite::runSchuetz(options);
  if (options.name == "guenther") return suite::runGuenther(options);
  throw UsageError("--suite", "found " + options.name + " (expected kanzok, schuetz or guenther)");
}

}  // namespace strata
