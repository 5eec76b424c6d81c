#pragma once
#include <cstdint>
#include <optional>

#include "converter/journal/build_folder.h"
#include "converter/journal/journal.h"
#include "converter/journal/spill.h"
#include "converter/options.h"
#include "io/scan/point_source.h"

namespace strata {

/// The building folder, the journal and the spill of one conversion. They are new, or an interrupted conversion left
/// them. One thread uses a session; several may use its spill and its journal.
class Session {
 public:
  /// With `options.resume` the session takes over an interrupted conversion. Throws Error when that conversion had
  /// other terms or its spill is gone, and then leaves its files alone.
  Session(const Sources& sources, const ConvertOptions& options);

  BuildFolder& folder() { return folder_; }
  Journal& journal() { return *journal_; }
  /// Only where isComplete() is false.
  Spill& spill() { return *spill_; }
  /// True when the store is whole and only its final name is missing.
  bool isComplete() const { return !spill_; }
  /// Leaves everything for a conversion with `options.resume`.
  void keep();
  /// Forgets everything that was journaled and spilled since the conversion began.
  void startAgain();

 private:
  void dropStrays();

  BuildFolder folder_;
  std::optional<Journal> journal_;
  std::optional<Spill> spill_;
  std::uint64_t headEnd_ = 0;  ///< of the journal's first record
};

}  // namespace strata
