#include <cstdint>
#include <string_view>

#include "core/error.h"
#include "io/table/pcd_header.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    strata::parsePcdHeader("fuzz.pcd", {reinterpret_cast<const char*>(data), size});
  } catch (const strata::Error&) {
  }
  return 0;
}
