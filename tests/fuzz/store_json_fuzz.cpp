#include <string>

#include "core/error.h"
#include "io/store/store.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    strata::parseStoreInfo("store.json", std::string(reinterpret_cast<const char*>(data), size));
  } catch (const strata::Error&) {
  }
  return 0;
}
