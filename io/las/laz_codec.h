#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/error.h"
#include "io/file/byte_source.h"
#include "io/file/output_file.h"
#include "io/las/las_record.h"
#include "io/las/laz_header.h"

namespace strata {

/// LAZ points are compressed in chunks. This is the place where they are decoded and encoded, by the LASzip library,
/// which no other file of ours includes.

/// Consecutive chunks, all of equal size except for the last, which LASzip decodes as one stream.
struct LazRun {
  std::vector<std::uint64_t> chunkEnds;  ///< in the file; empty when there is no chunk table
  std::uint64_t begin = 0, end = 0;      ///< bytes in the file
  std::uint64_t chunkPoints = 0;         ///< of every chunk but the last; 0 for a stream without chunks
  std::uint64_t points = 0;
};

/// Decodes one run. LASzip gets the bytes of the run inside a file that we make, so it never sees the header or the
/// chunk table of the real file.
class LazDecoder {
 public:
  /// `file` and `run` must outlive the decoder. Throws Error when LASzip refuses.
  LazDecoder(const ByteSource& file, const LasHeader& header, const LazFormat& format, const LazRun& run);
  ~LazDecoder();

  /// Points not yet decoded.
  std::uint64_t left() const;
  /// Decodes the next point into `record`, as it would be in a LAS file, or returns what is wrong with it. `firstPoint`
  /// is the number in the file of the first point of the run.
  std::optional<Error> next(std::uint64_t firstPoint, std::byte* record);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Appends compressed points and their chunk table to a file.
class LazEncoder {
 public:
  LazEncoder(OutputFile& file, const LasRecordFormat& format);
  ~LazEncoder();

  /// The data of the LASzip VLR that the file must have.
  const std::vector<std::uint8_t>& record() const;
  /// Begins to append points at the end of `file`, whose head must be complete.
  void start();
  /// Appends whole records as they would be in a LAS file.
  void write(std::span<const std::byte> records);
  /// Completes the last chunk and appends the chunk table.
  void finish();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace strata
