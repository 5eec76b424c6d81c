#pragma once
#include <filesystem>

#include "tests/support/las_maker.h"
#include "tests/support/real_scans.h"

namespace strata::test {

/// Reads the records of a LAS or LAZ file in their order by LASzip alone, without the code under test. `scratch` is a
/// folder for the uncompressed copy.
LasFile decodeLas(const std::filesystem::path& path, const std::filesystem::path& scratch);

/// Converts the scan, exports the store to LAS, and expects the same multiset of records, bit for bit.
/// It checks this decoder too: the records must have the SHA-256 that EXPECTED.tsv states.
void expectRecordsComeBack(const RealScan& scan);

}  // namespace strata::test
