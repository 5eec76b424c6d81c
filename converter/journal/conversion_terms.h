#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "converter/journal/journal.h"
#include "converter/options.h"

namespace strata {

/// What decides the bytes of a store. A conversion may only be resumed on the same terms.
struct ConversionTerms {
  struct Input {
    std::string path;
    std::uint64_t bytes = 0;
    std::int64_t changedNs = 0;  ///< since 1970; 0 for what is no file
  };
  std::vector<std::pair<std::string, std::string>> options;  ///< as on the command line, and their values
  std::vector<Input> inputs;
};

ConversionTerms termsOf(const std::vector<std::unique_ptr<PointSource>>& sources, const ConvertOptions& options);

/// Throws Error that names the first option or input in which `now` differs from what was `begun`; `folder` is where
/// the interrupted conversion lies.
void checkSameTerms(const std::string& folder, const ConversionTerms& begun, const ConversionTerms& now);

/// The first record of a journal.
struct JournalHead {
  std::string spillPath;  ///< empty = in the building folder
  ConversionTerms terms;
};
void appendHead(Journal& journal, const JournalHead& head);
/// Throws Error where the journal has none.
JournalHead readHead(const Journal& journal);

}  // namespace strata
