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

/// Points as they come out of a reader, positions apart from the packed attribute records.
struct PointBlock {
  std::vector<glm::dvec3> positions;  ///< metres, relative to SourceInfo::origin
  std::vector<glm::ivec3> integers;   ///< instead of positions, where readIntegers() filled the block
  std::vector<std::byte> attributes;  ///< positions.size() records of SourceInfo::layout.stride() bytes

  std::size_t count() const { return integers.empty() ? positions.size() : integers.size(); }
};

/// What is known of one scan before its points are read.
struct SourceInfo {
  std::string path;              ///< as the user gave it; for messages and the store's list of sources
  std::string format;            ///< "LAZ 1.4 format 8", "PLY binary", "synthetic city"
  std::uint64_t pointCount = 0;  ///< as the header claims, already checked against the file's size
  bool boundsExact = false;      ///< the header's bounds can be trusted to hold every point (else they are a hint)
  Box bounds;                    ///< world; empty when the format states none
  glm::dvec3 origin{0.0};        ///< what block positions are relative to (LAS: the header's offset)
  glm::dvec3 step{0.0};          ///< the source's grid (LAS: its scale factors); for float sources the size of
                                 ///< the last digit that carries information (text: of its decimals; float32:
                                 ///< about one ulp of the largest coordinate); 0 = unknown
  bool gridExact = false;        ///< every position is origin + integer * step
  bool float64 = false;          ///< coordinates are 64-bit floats on no grid (else, off a grid, they are 32-bit)
  PointLayout layout;
  std::string crs;  ///< WKT, or "EPSG:n", or empty
  std::uint64_t fileBytes = 0;
  std::uint64_t uncompressedBytes = 0;  ///< as plain records; what "input size" means for LAZ
  std::optional<LasMeta> las;
};

/// Reads the points of one part, front to back. Not thread-safe; one thread a reader.
class PointReader {
 public:
  virtual ~PointReader() = default;
  /// Replaces `block` by the next at most `maxPoints` points; false at the end of the part.
  /// Throws Error when the file is damaged or ends early; what was returned before stays valid.
  virtual bool read(PointBlock& block, std::size_t maxPoints) = 0;
  /// The same, but the block gets the integers of a LAS file, whose position is origin + LasMeta::scale * integer.
  /// Only for sources with SourceInfo::las; do not mix with read().
  virtual bool readIntegers(PointBlock& block, std::size_t maxPoints);
};

/// One scan. Constructing it reads headers only (text and PLY/PCD may have to look further).
class PointSource {
 public:
  virtual ~PointSource() = default;
  virtual const SourceInfo& info() const = 0;
  /// Parts can be read at the same time by different threads. Their order and content are fixed.
  virtual std::size_t partCount() const = 0;
  virtual std::unique_ptr<PointReader> openPart(std::size_t part) const = 0;
};

/// The user asked to stop.
class Stopped : public Error {
 public:
  Stopped() : Error("stopped before the end") {}
};

struct SourceOptions {
  std::string columns;  ///< text files: "x,y,z,intensity,r,g,b"; empty = detect
  std::uint64_t memoryBytes = std::uint64_t{2}
                              << 30;        ///< a source that must hold its file whole refuses beyond a share of this
  const std::atomic<bool>* stop = nullptr;  ///< opening throws Stopped soon after it is set
  bool skipDamaged = false;                 ///< read what is sound of a damaged file; what is missing counts as skipped
};

}  // namespace strata
