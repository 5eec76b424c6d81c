#include "core/error.h"

#include <system_error>

namespace strata {

Error posixError(const std::string& file, const std::string& doing, int errnoValue) {
  return Error(file, doing + ": " + std::generic_category().message(errnoValue));
}

}  // namespace strata
