// Points that wait in the temporary file come back as they were, by cell, in the order they were put there.
#include "converter/distribute/runs.h"

#include <gtest/gtest.h>

#include <random>

#include "converter/distribute/run_sorter.h"
#include "converter/journal/records.h"
#include "core/error.h"
#include "tests/support/las_maker.h"
#include "tests/support/run_program.h"

namespace strata {
namespace {

struct Shape {
  bool wide;
  std::size_t attributeBytes;
  int cubeBits, levels;
  unsigned varying;  ///< of the attribute bytes, the first so many differ
};

class EveryShape : public testing::TestWithParam<Shape> {
 protected:
  PackedFormat format() const { return {GetParam().wide, GetParam().attributeBytes}; }

  std::vector<std::byte> randomPoints(std::size_t count) const {
    std::mt19937_64 random(5);
    const PackedFormat packed = format();
    std::vector<std::byte> points(count * packed.stride(), std::byte{0x5a});
    const std::uint64_t mask = (std::uint64_t{1} << GetParam().cubeBits) - 1;
    for (std::size_t i = 0; i < count; ++i) {
      std::byte* record = points.data() + i * packed.stride();
      // Half of them close together, so that cells of many and of few points are there.
      const std::uint64_t spread = i % 2 == 0 ? mask : mask >> (GetParam().cubeBits / 2);
      packed.putPosition(record,
                         {static_cast<std::int64_t>(random() & spread), static_cast<std::int64_t>(random() & spread),
                          static_cast<std::int64_t>(random() & spread)});
      for (unsigned b = 0; b < GetParam().varying; ++b)
        record[packed.positionBytes() + b] = static_cast<std::byte>(random());
    }
    return points;
  }
};

/// One point as bytes.
using Record = std::vector<std::byte>;

TEST_P(EveryShape, OfRecordComesBackByCellInOrder) {
  const test::TempFolder folder;
  Journal journal((folder / "journal").string());
  Spill spill((folder / "spill").string(), Spill::Open::create);
  const PackedFormat packed = format();
  const CellGrid grid(NodeKey{}, GetParam().levels, GetParam().cubeBits);
  constexpr std::size_t kCount = 30000;
  const std::vector<std::byte> points = randomPoints(kCount);

  RunSorter sorter(packed, 10000, spill);
  sorter.aim(grid, 0);
  AttributeVariation variation;
  for (std::size_t at = 0; at < kCount; at += 3000) {
    const std::byte* block = points.data() + at * packed.stride();
    findVariation(block + packed.positionBytes(), packed.stride(), packed.attributeBytes, 3000, variation);
    sorter.add(block, 3000, variation);
  }
  RunsRecord runs{0, 0, std::nullopt, sorter.finish()};
  EXPECT_GT(runs.runs.size(), 1u);
  appendRuns(journal, runs);

  RunSet set(grid);
  for (WrittenRun& w : runs.runs) {
    EXPECT_LE(w.run.shape.stride(), packed.stride());
    set.runs.push_back(w.run);
  }
  std::vector<std::vector<Record>> expected(grid.cells()), found(grid.cells());
  const auto cellOf = [&](const std::byte* record) {
    std::int64_t p[3];
    packed.getPosition(record, p);
    std::size_t cell = 0;
    for (int bit = GetParam().levels - 1; bit >= 0; --bit)
      for (const std::int64_t v : p) cell = cell << 1 | (static_cast<std::uint64_t>(v) >> grid.shift >> bit & 1);
    return cell;
  };
  for (std::size_t i = 0; i < kCount; ++i) {
    const std::byte* record = points.data() + i * packed.stride();
    expected[cellOf(record)].emplace_back(record, record + packed.stride());
  }
  RunCursor cursor(set, journal);
  std::vector<std::byte> scratch;
  for (std::size_t first = 0; first < grid.cells();) {
    const std::size_t end = std::min(grid.cells(), first + 1 + first % 3);
    for (const Stretch& stretch : cursor.take(first, end)) {
      StretchReader reader(spill, grid, packed, stretch);
      for (std::size_t piece = 1; reader.left() > 0; piece = piece * 2 + 1) {
        const std::size_t count = std::min<std::uint64_t>(piece, reader.left());
        std::vector<std::byte> out(count * packed.stride());
        reader.read(count, scratch, out.data());
        for (std::size_t i = 0; i < count; ++i) {
          const std::byte* record = out.data() + i * packed.stride();
          found[cellOf(record)].emplace_back(record, record + packed.stride());
        }
      }
    }
    first = end;
  }
  EXPECT_TRUE(found == expected);
}

TEST_P(EveryShape, DamagedInTheFileIsFound) {
  if (GetParam().cubeBits == GetParam().levels && GetParam().varying == 0) GTEST_SKIP() << "nothing of it is stored";
  const test::TempFolder folder;
  Journal journal((folder / "journal").string());
  Spill spill((folder / "spill").string(), Spill::Open::create);
  const PackedFormat packed = format();
  const CellGrid grid(NodeKey{}, GetParam().levels, GetParam().cubeBits);
  const std::vector<std::byte> points = randomPoints(5000);
  RunSorter sorter(packed, 10000, spill);
  sorter.aim(grid, 0);
  AttributeVariation variation;
  findVariation(points.data() + packed.positionBytes(), packed.stride(), packed.attributeBytes, 5000, variation);
  sorter.add(points.data(), 5000, variation);
  RunsRecord runs{0, 0, std::nullopt, sorter.finish()};
  appendRuns(journal, runs);
  RunSet set(grid);
  for (WrittenRun& w : runs.runs) set.runs.push_back(w.run);

  std::string bytes = test::readWhole(folder / "spill");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  test::writeBytes(folder / "spill", bytes);
  RunCursor cursor(set, journal);
  std::vector<std::byte> scratch, out(5000 * packed.stride());
  const auto readAll = [&] {
    for (const Stretch& stretch : cursor.take(0, grid.cells()))
      StretchReader(spill, grid, packed, stretch).read(stretch.points, scratch, out.data());
  };
  EXPECT_THROW(readAll(), Error);
}

INSTANTIATE_TEST_SUITE_P(Runs, EveryShape,
                         testing::Values(Shape{false, 0, 12, 3, 0}, Shape{false, 1, 8, 2, 1},
                                         Shape{false, 16, 21, 5, 9}, Shape{false, 16, 32, 0, 16},
                                         Shape{false, 45, 30, 4, 45}, Shape{false, 7, 5, 5, 3},
                                         Shape{true, 16, 40, 5, 4}, Shape{true, 3, 52, 2, 3},
                                         Shape{true, 60, 36, 5, 0}));

}  // namespace
}  // namespace strata
