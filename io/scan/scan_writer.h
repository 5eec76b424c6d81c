#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/box.h"
#include "io/store/node_codec.h"
#include "io/store/store_info.h"

namespace strata {

/// Writes points of a store to a file of another format, for strata-export. The file is written as `PATH.part` and gets
/// its name from finish(); the destructor removes an unfinished one.
class ScanWriter {
 public:
  virtual ~ScanWriter() = default;
  /// Appends points: integers of the store's grid and records of the store's layout. Throws Error.
  virtual void write(const NodePoints& points) = 0;
  /// Completes the file. Throws Error when it is not written whole.
  virtual void finish() = 0;
};

/// The points that a ScanWriter will be given.
struct ExportedPoints {
  std::uint64_t count = 0;
  Box bounds;  ///< world
};

struct LasWriterOptions {
  bool compress = false;           ///< LAZ
  std::optional<int> pointFormat;  ///< 0 to 3 or 6 to 8, written as LAS 1.4; without it the writer chooses one
};

/// Creates a LAS or LAZ file. If the store came from LAS and the points fit, the file has the source's point format,
/// version, VLRs, scale and offset, and every record comes out bit for bit. Otherwise it has the smallest of formats 6,
/// 7 and 8 that holds the attributes. Attributes that LAS has no field for become extra bytes.
std::unique_ptr<ScanWriter> createLasWriter(const std::string& path, const StoreInfo& info,
                                            const ExportedPoints& points, const LasWriterOptions& options);

/// Creates a binary little-endian PLY file of `points` points: x y z as doubles, red green blue in 8 bits, and every
/// other attribute under its own name.
std::unique_ptr<ScanWriter> createPlyWriter(const std::string& path, const StoreInfo& info, std::uint64_t points);

}  // namespace strata
