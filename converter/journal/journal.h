#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/mutex.h"

namespace strata {

/// The kinds of journal records; journal/records.h says what each of them holds.
enum class RecordKind : std::uint32_t {
  options = 1,   ///< what decides the store's bytes, and where the spill lies
  measured = 2,  ///< where the points of sources lie whose headers do not say
  runs = 3,      ///< runs that are now in the spill
  split = 4,     ///< a cell that is about to be split, and how
  chunk = 5,     ///< a chunk whose nodes are in points.bin
  complete = 6,  ///< the store's files are whole and durable; only their final name is missing
};

/// The log that lets an interrupted conversion go on: records that are only ever appended, each with its checksum, so
/// that a conversion that was killed at any moment goes on behind the last whole record. All functions but rewind() are
/// thread-safe. Failures throw Error.
class Journal {
 public:
  /// A record that was there when the journal was opened.
  struct FoundRecord {
    RecordKind kind;
    std::uint64_t offset;  ///< of the payload in the file
    std::uint64_t bytes;   ///< of the payload
  };

  /// Opens or creates `path` and finds the sound records. It cuts off everything behind the last of them.
  explicit Journal(std::string path);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// The records that were there when the journal was opened, in their order.
  const std::vector<FoundRecord>& found() const { return found_; }
  /// Appends a record and returns the offset of its payload.
  std::uint64_t append(RecordKind kind, std::span<const std::byte> payload) STRATA_EXCLUDES(mutex_);
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;
  std::vector<std::byte> payload(const FoundRecord& record) const;
  /// Forgets all records that begin at `end` or behind it. No other function may run at the same time.
  void rewind(std::uint64_t end) STRATA_EXCLUDES(mutex_);

  const std::string& path() const { return path_; }
  std::uint64_t bytes() const STRATA_EXCLUDES(mutex_);

 private:
  const std::string path_;
  int descriptor_ = -1;
  std::vector<FoundRecord> found_;  ///< changed by rewind() alone

  mutable Mutex mutex_;
  std::uint64_t end_ STRATA_GUARDED_BY(mutex_) = 0;  ///< of the last record
};

}  // namespace strata
