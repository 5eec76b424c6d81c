#include "tests/support/paths.h"

namespace strata::test {

// The only source that knows these paths, so that objects of the others are the same in every build folder.
std::filesystem::path sourceFolder() { return STRATA_SOURCE_DIR; }
std::filesystem::path programFolder() { return STRATA_BIN_DIR; }

}  // namespace strata::test
