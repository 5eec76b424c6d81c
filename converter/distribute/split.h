#pragma once
#include <cstdint>
#include <deque>
#include <vector>

#include "converter/distribute/chunks.h"
#include "converter/journal/conversion.h"
#include "converter/survey/survey.h"

namespace strata {

/// Splits the cells of more than `chunkLimit` points of `sets`, and of the run sets that this makes, until none is left
/// that can be split, and returns the chunks. `sets` holds all points in its only set when it is called; the journal
/// may know of others already. In memory at any time: one run per thread. Throws Error and Stopped.
std::vector<Chunk> splitIntoChunks(const Conversion& conversion, const Survey& survey, std::uint64_t chunkLimit,
                                   std::deque<RunSet>& sets);

}  // namespace strata
