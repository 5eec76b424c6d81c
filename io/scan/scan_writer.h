#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "io/store/node_codec.h"
#include "io/store/store.h"

namespace strata {

/// Writes points of a store to a file of another format, for strata-export. The file is built under a name of its
/// own (`PATH.part`) and carries its final name only after finish(); the destructor removes what is unfinished.
class ScanWriter {
 public:
  virtual ~ScanWriter() = default;
  /// Appends points; grid integers of the store's grid, records of the store's layout. Throws Error.
  virtual void write(const NodePoints& points) = 0;
  virtual void finish() = 0;
};

/// LAS or LAZ with the source's point format, version, VLRs, scale and offset where the store came from LAS and the
/// points fit (then records come out bit for bit); else the smallest of formats 6, 7, 8 that holds the attributes.
/// `pointFormat` asks for another one: 0 to 3 or 6 to 8, in LAS 1.4. `points` and `bounds` are of what will be
/// written. Attributes that LAS has no field for become extra bytes.
std::unique_ptr<ScanWriter> createLasWriter(const std::string& path, const StoreInfo& info, std::uint64_t points,
                                            const Box& bounds, bool compress, std::optional<int> pointFormat = {});

/// Binary little-endian PLY: double x y z, 8-bit red green blue, and every other attribute under its own name.
std::unique_ptr<ScanWriter> createPlyWriter(const std::string& path, const StoreInfo& info, std::uint64_t points);

}  // namespace strata
