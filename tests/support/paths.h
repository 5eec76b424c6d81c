#pragma once
#include <filesystem>

namespace strata::test {

/// The root of the sources that the tests were built from.
std::filesystem::path sourceFolder();
/// The folder of the programs that were built together with the tests.
std::filesystem::path programFolder();

}  // namespace strata::test
