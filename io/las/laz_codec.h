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

/// Consecutive chunks of equal size, but for the last one. LASzip decodes them as one stream.
struct LazRun {
  std::vector<std::uint64_t> chunkEnds;  ///< in the file; empty where there is no chunk table
  std::uint64_t begin = 0, end = 0;      ///< bytes in the file
  std::uint64_t chunkPoints = 0;         ///< of every chunk but the last; 0 for a stream without chunks
  std::uint64_t points = 0;
};

/// LASzip's reader of one run. It is shown a file of our making around the run's bytes, so nothing that the real
/// file's header or chunk table says reaches it.
class LazDecoder {
 public:
  /// `file`, `run` must outlive it.
  LazDecoder(const ByteSource& file, const LasHeader& header, const LazFormat& format, const LazRun& run);
  ~LazDecoder();

  /// Points not yet decoded.
  std::uint64_t left() const;
  /// Decodes the next point into `record`, as it would stand in a LAS file, or says what is wrong with it.
  /// `firstPoint` is the number in the file of the run's first point.
  std::optional<Error> next(std::uint64_t firstPoint, std::byte* record);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// LASzip's writer: appends compressed points and their chunk table to a file.
class LazEncoder {
 public:
  LazEncoder(OutputFile& file, const LasRecordFormat& format);
  ~LazEncoder();

  /// The LASzip record that has to stand among the VLRs.
  const std::vector<std::uint8_t>& record() const;
  /// From here on points go to the end of `file`.
  void start();
  /// Whole records as they would stand in a LAS file.
  void write(std::span<const std::byte> records);
  void finish();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace strata
