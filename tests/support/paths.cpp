#include "tests/support/paths.h"

namespace strata::test {

// No other source knows these paths, so that the objects of the others are the same in every build folder.
std::filesystem::path sourceFolder() { return STRATA_SOURCE_DIR; }
std::filesystem::path programFolder() { return STRATA_BIN_DIR; }

}  // namespace strata::test
