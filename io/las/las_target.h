#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/las/las_record.h"
#include "io/store/store.h"

namespace strata {

/// How points of a store become records of a LAS file.
struct LasTarget {
  /// `bytes` of a store's record that stand elsewhere in the file's packed record.
  struct Copy {
    std::size_t from, to, bytes;
  };

  LasMeta meta;  ///< of the file, its VLRs included but for LASzip's
  LasRecordFormat format;
  std::vector<Copy> copies;
  bool sameRecords = false;  ///< packed records are the store's as they are
  int rankAt = -1;           ///< in the store's record: degrees to be turned into a scan angle at angleAt
  std::size_t angleAt = 0;
  glm::i64vec3 shift{0};   ///< integer of the file = (integer of the store + shift) / divide
  glm::i64vec3 divide{1};  ///< above 1 where the store's steps are fractions of the source's
};

/// The source's own format, records and grid where the points fit them; else the smallest of formats 6, 7, 8.
/// `pointFormat` (0 to 3 or 6 to 8) asks for that one. Throws Error, naming `file`, when the points fit no grid of
/// 32-bit integers with the store's step, or the asked format's bit fields.
LasTarget chooseLasTarget(const std::string& file, const StoreInfo& info, std::uint64_t points, const Box& bounds,
                          std::optional<int> pointFormat = {});

}  // namespace strata
