#pragma once
#include <cstdint>

#include "converter/distribute/chunks.h"
#include "converter/journal/conversion.h"
#include "converter/survey/survey.h"

namespace strata {

/// Reads all sources, in parallel over their parts, into cells of the octree, splits cells of more than `chunkLimit`
/// points and joins small neighbours up to it. Work that the journal has is not done again. In memory at any time:
/// one run per thread, within a quarter of `memoryBytes`. Throws Error and Stopped.
Distribution distribute(const Conversion& conversion, const Survey& survey, std::uint64_t chunkLimit);

}  // namespace strata
