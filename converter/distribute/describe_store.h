#pragma once
#include "converter/distribute/chunks.h"
#include "converter/journal/conversion.h"
#include "converter/survey/survey.h"
#include "io/store/store.h"

namespace strata {

/// Throws Error where a source had fewer points than its header claims, since damage that a reader did not notice shows
/// in that way; with `skipDamaged` the missing points count as skipped. Throws Error where no point is left.
void checkCounts(const Sources& sources, bool skipDamaged, Distribution& all);

/// Describes the store as far as it is known once all points are distributed: everything but nodes and levels.
StoreInfo describeStore(const Conversion& conversion, const Survey& survey, const Distribution& all);

}  // namespace strata
