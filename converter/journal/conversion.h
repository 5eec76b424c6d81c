#pragma once
#include "converter/control.h"
#include "converter/journal/journal.h"
#include "converter/journal/spill.h"
#include "converter/options.h"
#include "io/scan/point_source.h"

namespace strata {

/// The context that all stages of one conversion share. Its members outlive every stage; all of them may be used by
/// several threads at once.
struct Conversion {
  const Sources& sources;
  const ConvertOptions& options;  ///< `threads` is the real number, not 0
  const ConvertControl& control;
  Spill& spill;
  Journal& journal;
};

}  // namespace strata
