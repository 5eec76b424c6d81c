#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "io/synthetic/shape_source.h"

namespace strata {
namespace {

struct Columns {
  std::vector<glm::dvec3> positions;
  std::vector<std::byte> attributes;
  bool operator==(const Columns&) const = default;
};

Columns readPart(const PointSource& source, std::size_t part, std::size_t blockPoints) {
  Columns all;
  PointBlock block;
  const auto reader = source.openPart(part);
  while (reader->read(block, blockPoints)) {
    all.positions.insert(all.positions.end(), block.positions.begin(), block.positions.end());
    all.attributes.insert(all.attributes.end(), block.attributes.begin(), block.attributes.end());
  }
  return all;
}

class SyntheticShapes : public testing::TestWithParam<const char*> {
 protected:
  std::string spec(const std::string& rest) const { return std::string("synthetic:") + GetParam() + "?" + rest; }
};

TEST_P(SyntheticShapes, HoldExactlyTheCountThatWasAskedFor) {
  for (const std::uint64_t points : {1u, 2u, 999u, 1'000'000u, 1'000'003u}) {
    const auto source = synthetic::openScan(spec("points=" + std::to_string(points)));
    std::uint64_t count = 0;
    for (std::size_t part = 0; part < source->partCount(); ++part) {
      const Columns columns = readPart(*source, part, 65'536);
      EXPECT_EQ(columns.attributes.size(), columns.positions.size() * source->info().layout.stride());
      count += columns.positions.size();
    }
    EXPECT_EQ(count, points);
  }
}

TEST_P(SyntheticShapes, GiveEveryPartTheSameBytesHoweverItIsRead) {
  const auto one = synthetic::openScan(spec("points=2100000&seed=5")),
             other = synthetic::openScan(spec("points=2100000&seed=5"));
  const Columns first = readPart(*one, 0, 1'000'000);
  const Columns last = readPart(*one, 2, 1'000'000);
  EXPECT_EQ(readPart(*other, 2, 777), last);  // alone, in another instance, in other blocks
  Columns beside[2];
  {
    std::jthread a([&] { beside[0] = readPart(*other, 0, 4096); });
    std::jthread b([&] { beside[1] = readPart(*other, 2, 4097); });
  }
  EXPECT_EQ(beside[0], first);
  EXPECT_EQ(beside[1], last);
}

TEST_P(SyntheticShapes, DifferBySeed) {
  const auto one = synthetic::openScan(spec("points=20000&seed=1")),
             other = synthetic::openScan(spec("points=20000&seed=2"));
  EXPECT_NE(readPart(*one, 0, 20'000), readPart(*other, 0, 20'000));
}

TEST_P(SyntheticShapes, StayInTheirBoundsAndOnTheirGrid) {
  const auto source = synthetic::openScan(spec("points=1500000&seed=3"));
  const SourceInfo& info = source->info();
  ASSERT_TRUE(info.boundsExact);
  for (std::size_t part = 0; part < source->partCount(); ++part) {
    for (const glm::dvec3& p : readPart(*source, part, 100'000).positions) {
      ASSERT_TRUE(info.bounds.contains(info.origin + p)) << p.x << ' ' << p.y << ' ' << p.z;
      for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(p[axis], std::round(p[axis] / info.step[axis]) * info.step[axis]);
    }
  }
}

TEST_P(SyntheticShapes, FillTheirBounds) {
  const auto source = synthetic::openScan(spec("points=1000000"));
  Box seen;
  for (const glm::dvec3& p : readPart(*source, 0, 1'000'000).positions) seen.add(source->info().origin + p);
  const glm::dvec3 declared = source->info().bounds.size();
  EXPECT_GT(seen.size().x, declared.x * 0.8);  // a handful of points spans the degenerate scan
  EXPECT_GT(seen.size().y, declared.y * 0.8);
  EXPECT_GE(seen.size().z, declared.z * 0.5);  // the highest peak may be lower than the highest possible one
}

TEST_P(SyntheticShapes, MakeTheLastPartOfTheLargestScanAlone) {
  const auto source = synthetic::openScan(spec("points=1e11"));
  ASSERT_EQ(source->partCount(), 100'000u);
  PointBlock block;
  ASSERT_TRUE(source->openPart(99'999)->read(block, 1000));
  EXPECT_EQ(block.count(), 1000u);
  for (const glm::dvec3& p : block.positions) ASSERT_TRUE(source->info().bounds.contains(source->info().origin + p));
}

INSTANTIATE_TEST_SUITE_P(All, SyntheticShapes,
                         testing::Values("plane", "room", "city", "terrain", "stack", "sphere", "degenerate"),
                         [](const auto& shape) { return std::string(shape.param); });

}  // namespace
}  // namespace strata
