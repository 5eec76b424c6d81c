#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "converter/options.h"
#include "io/scan/point_source.h"

namespace strata {

/// The options and inputs that decide the bytes of a store. A conversion may only be resumed on the same terms.
struct ConversionTerms {
  struct Input {
    std::string path;
    std::uint64_t bytes = 0;
    std::int64_t changedNs = 0;  ///< last change, since 1970; 0 for inputs that are no file
  };
  std::vector<std::pair<std::string, std::string>> options;  ///< names as on the command line, and values
  std::vector<Input> inputs;                                 ///< in their order
};

ConversionTerms termsOf(const Sources& sources, const ConvertOptions& options);

/// Throws Error that names the first option or input in which `now` differs from the terms that were `begun`. `folder`
/// is the building folder of the interrupted conversion.
void checkSameTerms(const std::string& folder, const ConversionTerms& begun, const ConversionTerms& now);

}  // namespace strata
