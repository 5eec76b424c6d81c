#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/las/las_record.h"
#include "io/scan/scan_writer.h"
#include "io/store/store_info.h"

namespace strata {

/// Maps the attributes of a store to the fields of a LAS file, and grid positions to the integers of that file.
struct LasExportLayout {
  /// `bytes` of a store's record at `from` go to `to` in the file's packed record (lasLayout()).
  struct Copy {
    std::size_t from, to, bytes;
  };

  LasMeta meta;  ///< of the file, with all VLRs but LASzip's
  LasRecordFormat format;
  std::vector<Copy> copies;
  bool sameRecords = false;  ///< packed records are equal to the store's
  int rankAt = -1;           ///< where the store's record has a scan angle rank that becomes a scan angle; -1 for none
  std::size_t angleAt = 0;   ///< where the packed record has that scan angle
  glm::i64vec3 shift{0};     ///< integer of the file = (integer of the store + shift) / divide
  glm::i64vec3 divide{1};    ///< above 1 when the store's steps are fractions of the source's
};

/// Chooses the source's own format, records and grid when the points fit them, else the smallest of formats 6, 7 and 8.
/// `pointFormat` (0 to 3 or 6 to 8) asks for another format. Throws Error naming `file` when the points fit no grid of
/// 32-bit integers with the store's step, or not the bit fields of the format that was asked for.
LasExportLayout chooseLasExportLayout(const std::string& file, const StoreInfo& info, const ExportedPoints& points,
                                      std::optional<int> pointFormat = {});

}  // namespace strata
