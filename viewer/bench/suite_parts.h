#pragma once
#include "viewer/bench/suite.h"

namespace strata::suite {

void runKanzok(const SuiteOptions& options);
void runSchuetz(const SuiteOptions& options);
void runGuenther(const SuiteOptions& options);

}  // namespace strata::suite
