#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace strata::test {

/// A cloud as PCL's own readers see it.
struct PclCloud {
  std::uint64_t points = 0;
  std::vector<std::string> fields;
  std::vector<std::vector<double>> values;  ///< one vector a field, its first component
};

/// Nothing where PCL cannot read the file.
std::optional<PclCloud> readWithPcl(const std::string& path);

}  // namespace strata::test
