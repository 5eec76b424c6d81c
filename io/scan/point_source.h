#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/box.h"
#include "core/error.h"
#include "core/point_layout.h"
#include "io/store/las_meta.h"

namespace strata {

/// Points as a reader hands them out: coordinates, and apart from them the attribute records. The coordinates are in
/// `positions`, or in `integers` when the reader came from PointSource::openIntegers(); the other vector is empty.
struct PointBlock {
  std::vector<glm::dvec3> positions;  ///< metres, relative to SourceInfo::origin
  std::vector<glm::ivec3> integers;   ///< as a LAS file stores them; position = LasMeta::scale * integer
  std::vector<std::byte> attributes;  ///< one record of SourceInfo::layout.stride() bytes for each point

  std::size_t count() const { return integers.empty() ? positions.size() : integers.size(); }
};

/// Everything that is known of one scan before its points are read.
struct SourceInfo {
  std::string path;              ///< as the user gave it; for messages and the store's list of sources
  std::string format;            ///< "LAZ 1.4 format 8", "PLY binary", "synthetic city"
  std::uint64_t pointCount = 0;  ///< as the header claims; already checked against the file's size
  bool boundsExact = false;      ///< `bounds` hold every point; otherwise they are a hint
  Box bounds;                    ///< world; empty when the format states none
  glm::dvec3 origin{0.0};        ///< world position that block positions are relative to (LAS: the header's offset)
  /// The step of the source's grid (LAS: its scale factors). Without a grid it is the size of the last digit that
  /// carries information: about one unit in the last place of the largest coordinate for float32. 0 means unknown.
  glm::dvec3 step{0.0};
  bool gridExact = false;  ///< every position is origin + integer * step
  bool float64 = false;    ///< the coordinates are 64-bit floats without a grid; otherwise, without a grid, 32-bit ones
  PointLayout layout;
  std::string crs;  ///< WKT, or "EPSG:n", or empty
  std::uint64_t fileBytes = 0;
  std::uint64_t uncompressedBytes = 0;  ///< as plain records; the "input size" of a LAZ file
  std::optional<LasMeta> las;           ///< for LAS and LAZ alone
  std::optional<glm::dvec3> viewpoint;  ///< world position that the sensor stood at, when the file says so (PCD)
};

/// Reads the points of one part, front to back. Each reader belongs to one thread at a time.
class PointReader {
 public:
  virtual ~PointReader() = default;
  /// Replaces `block` by the next points, at most `maxPoints`. Returns false at the end of the part. Throws Error when
  /// the file is damaged or ends early; blocks that were read before stay valid. A block that is read into again must
  /// come from a reader of the same kind, openPart() or openIntegers().
  virtual bool read(PointBlock& block, std::size_t maxPoints) = 0;
};

/// One scan that is open for reading. Opening it reads the headers only, except for text, ascii and compressed files,
/// which have to be looked through. All members may be called by several threads at once; readers must not outlive it.
class PointSource {
 public:
  virtual ~PointSource() = default;
  virtual const SourceInfo& info() const = 0;
  /// Parts can be read at the same time by different threads. Their order and their points never change.
  virtual std::size_t partCount() const = 0;
  virtual std::unique_ptr<PointReader> openPart(std::size_t part) const = 0;
  /// Like openPart(), but a source with SourceInfo::las hands out PointBlock::integers instead of positions, which
  /// spares a conversion to metres and back. Any other source hands out positions.
  virtual std::unique_ptr<PointReader> openIntegers(std::size_t part) const { return openPart(part); }
};

/// Scans that are taken as one cloud.
using Sources = std::vector<std::unique_ptr<PointSource>>;

/// Thrown when the user asked to stop.
class Stopped : public Error {
 public:
  Stopped() : Error("stopped before the end") {}
};

/// How scans are opened.
struct SourceOptions {
  std::string columns;  ///< of text files, as "x,y,z,intensity,r,g,b"; empty to detect them
  /// Memory of the whole conversion. A source that has to hold its file whole refuses when that takes too large a
  /// share.
  std::uint64_t memoryBytes = std::uint64_t{2} << 30;
  const std::atomic<bool>* stop = nullptr;  ///< opening throws Stopped soon after it is set
  bool skipDamaged = false;  ///< damaged files give their undamaged points, and the missing ones count as skipped
};

}  // namespace strata
