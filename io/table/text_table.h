#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "io/table/field.h"

namespace strata {

/// How one column of a line is read.
struct TextColumn {
  enum class Kind : std::uint8_t {
    skip,
    value,   ///< a number of the field
    packed,  ///< a colour of 4 bytes, written as an integer or as the float that has its bits
    list     ///< a count n and n more columns, none of which are kept (PLY)
  };
  Kind kind = Kind::value;
  std::size_t field = 0;  ///< index into TextTable::fields
  std::size_t value = 0;  ///< index of the number within the field
};

/// Points that are lines of numbers in a range of a file: the body of text scans and of ascii PLY and PCD.
struct TextTable {
  std::string format;               ///< for SourceInfo
  std::vector<TextColumn> columns;  ///< further columns of a line are ignored
  std::vector<Field> fields;        ///< of the record that a line becomes
  std::size_t recordBytes = 0;
  bool comments = false;    ///< lines that start with # or // are comments
  bool countLines = false;  ///< lines of a single integer count the points that follow (PTS, one before each scan)
  const std::atomic<bool>* stop = nullptr;
  bool skipDamaged = false;  ///< leaves lines out that cannot be read, instead of throwing
  std::uint64_t begin = 0;   ///< range in the file, bytes; both ends are at the start of a line
  std::uint64_t end = 0;
  std::uint64_t firstLine = 1;          ///< number of the line at `begin`
  std::uint64_t claimedPoints = 0;      ///< as a header says; 0 when none does
  std::optional<glm::dvec3> viewpoint;  ///< for SourceInfo
};

/// Gives the fields their offsets, one behind the other, and the table its recordBytes.
void packFields(TextTable& table);

}  // namespace strata
