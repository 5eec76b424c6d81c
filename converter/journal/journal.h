#pragma once
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace strata {

/// What a journal record tells.
enum class RecordKind : std::uint32_t {
  options = 1,   ///< what decides the store's bytes, and where the temporary points are
  measured = 2,  ///< where the points of sources lie whose headers cannot tell
  runs = 3,      ///< points of some input (or of a cell that is split) that are now in the temporary file
  split = 4,     ///< a cell that is about to be split, and how
  chunk = 5,     ///< a chunk whose nodes are in points.bin
  complete = 6,  ///< the store's files are whole and durable; only their name is missing
};

/// The log of a conversion: records that are only ever appended, each with its checksum, so that a conversion that
/// was killed at any moment goes on behind the last whole one. Thread-safe but where said; failures throw Error.
class Journal {
 public:
  struct Place {
    RecordKind kind;
    std::uint64_t offset;  ///< of the payload in the file
    std::uint64_t bytes;   ///< of the payload
  };

  /// Opens or creates `path` and finds the sound records; what follows the last of them is cut off.
  explicit Journal(std::string path);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// The records that were there when the journal was opened, in their order.
  const std::vector<Place>& found() const { return found_; }
  /// Appends a record and returns where its payload stands.
  std::uint64_t append(RecordKind kind, std::span<const std::byte> payload);
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;
  std::vector<std::byte> payload(const Place& place) const;
  /// Forgets all records that begin at `end` or behind. Nobody else may be calling.
  void rewind(std::uint64_t end);

  const std::string& path() const { return path_; }
  std::uint64_t bytes() const;

 private:
  const std::string path_;
  int descriptor_ = -1;
  std::vector<Place> found_;  ///< constant but for rewind()
  mutable std::mutex mutex_;
  std::uint64_t end_ = 0;  ///< guarded by mutex_
};

}  // namespace strata
