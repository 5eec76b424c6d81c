#pragma once
#include <string>

namespace strata {

/// The version that the programs print and stores state, as in "0.2.0". CMakeLists.txt is its only source.
std::string version();

/// The commit that this build was made from, as `git describe` names it, with "-dirty" where sources had been changed;
/// "unknown" where the sources came without their repository.
std::string commit();

}  // namespace strata
