#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace strata::test {

/// A cloud as PCL's own readers read it.
struct PclCloud {
  std::uint64_t points = 0;
  std::vector<std::string> fields;
  std::vector<std::vector<double>> values;  ///< for each field the values of its first component
};

/// Reads a file with PCL; nothing when PCL cannot.
std::optional<PclCloud> readWithPcl(const std::string& path);

}  // namespace strata::test
