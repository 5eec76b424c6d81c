#pragma once
#include "converter/distribute/distribute.h"

namespace strata {

/// Splits the cells of more than `limit` points of all sets, and of what comes of them, into sets of their own, and
/// fills in the buckets. `all.sets` holds all points in its first set; the journal may know of others already.
void splitAndMerge(Distribution& all, const Survey& frame, const PackedFormat& format, std::uint64_t limit,
                   const ConvertOptions& options, Workspace work, const ConvertControl& control);

}  // namespace strata
