#include <fstream>

#include "core/error.h"
#include "io/scan/scan_writer.h"
#include "io/table/ply_source.h"
#include "tests/support/scan_points.h"

namespace strata {
namespace {

namespace fs = std::filesystem;
using namespace test;

StoreInfo storeOf(std::vector<Attribute> attributes) {
  StoreInfo info;
  info.grid.scale = glm::dvec3(0.01);
  info.grid.offset = glm::dvec3(500000.0, 5400000.0, -10.0);
  info.layout = PointLayout(std::move(attributes));
  return info;
}

/// Points whose attribute bytes are all different.
NodePoints pointsOf(const StoreInfo& info, std::int64_t count, std::int64_t first = 0) {
  NodePoints points;
  for (std::int64_t i = first; i < first + count; ++i) {
    points.grid[0].push_back(i * 3);
    points.grid[1].push_back(i * 5);
    points.grid[2].push_back(i * 7);
    for (std::size_t b = 0; b < info.layout.stride(); ++b)
      points.attributes.push_back(static_cast<std::byte>((static_cast<std::size_t>(i) * 31 + b * 7) & 127));
  }
  return points;
}

std::vector<Attribute> mixedAttributes() {
  return {{.name = "rgb", .type = ScalarType::u16, .components = 3, .description = {}},
          {.name = "intensity", .type = ScalarType::u16, .components = 1, .description = {}},
          {.name = "classification", .type = ScalarType::u8, .components = 1, .description = {}},
          {.name = "gps_time", .type = ScalarType::f64, .components = 1, .description = {}},
          {.name = "normal", .type = ScalarType::f32, .components = 3, .description = {}},
          {.name = "extra:my value", .type = ScalarType::i32, .components = 1, .description = {}},
          {.name = "extra:id", .type = ScalarType::u64, .components = 2, .description = {}}};
}

TEST(PlyWriter, WhatItWritesReadsBackTheSame) {
  const TempFolder folder;
  const std::string path = (folder / "out.ply").string();
  const StoreInfo info = storeOf(mixedAttributes());
  const NodePoints first = pointsOf(info, 1000), second = pointsOf(info, 500, 1000);
  const auto writer = createPlyWriter(path, info, 1500);
  writer->write(first);
  writer->write(second);
  EXPECT_FALSE(fs::exists(path));
  writer->finish();
  EXPECT_FALSE(fs::exists(path + ".part"));

  const auto source = openPly(path, {});
  const PointBlock points = readSource(*source);
  ASSERT_EQ(points.count(), 1500u);
  EXPECT_TRUE(source->info().gridExact);
  EXPECT_EQ(source->info().step, glm::dvec3(0.01));
  for (std::size_t i = 0; i < 1500; ++i) {
    const NodePoints& from = i < 1000 ? first : second;
    const std::size_t k = i < 1000 ? i : i - 1000;
    const std::byte* record = from.attributes.data() + k * info.layout.stride();
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(points.positions[i][axis], info.grid.offset[axis] + 0.01 * static_cast<double>(from.grid[axis][k]));
    const auto stored = [&](const char* name, std::size_t component) {
      const auto index = static_cast<std::size_t>(info.layout.find(name));
      const ScalarType type = info.layout.attributes()[index].type;
      return loadScalar(record + info.layout.offset(index) + component * scalarBytes(type), type);
    };
    for (const char* name : {"intensity", "classification", "gps_time"})
      EXPECT_EQ(valueOf(*source, points, i, name), stored(name, 0)) << name;
    EXPECT_EQ(valueOf(*source, points, i, "extra:my_value"), stored("extra:my value", 0));
    EXPECT_EQ(valueOf(*source, points, i, "extra:id_1"), stored("extra:id", 1));
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(valueOf(*source, points, i, "normal", c), stored("normal", c));
      EXPECT_EQ(valueOf(*source, points, i, "rgb", c), static_cast<std::uint16_t>(stored("rgb", c)) & 255);
    }
  }
}

TEST(PlyWriter, DrawsSixteenBitColoursFromTheirUpperByte) {
  const TempFolder folder;
  StoreInfo info = storeOf({{.name = "rgb", .type = ScalarType::u16, .components = 3, .description = {}}});
  info.colourShift = 8;
  NodePoints points = pointsOf(info, 1);
  const std::uint16_t rgb[3] = {0xff00, 0x8012, 0x0034};
  std::memcpy(points.attributes.data(), rgb, sizeof rgb);
  const auto writer = createPlyWriter((folder / "out.ply").string(), info, 1);
  writer->write(points);
  writer->finish();
  const auto source = openPly((folder / "out.ply").string(), {});
  const PointBlock read = readSource(*source);
  EXPECT_EQ(valueOf(*source, read, 0, "rgb", 0), 255.0);
  EXPECT_EQ(valueOf(*source, read, 0, "rgb", 1), 128.0);
  EXPECT_EQ(valueOf(*source, read, 0, "rgb", 2), 0.0);
}

TEST(PlyWriter, AnUnfinishedFileLeavesNothingBehind) {
  const TempFolder folder;
  const StoreInfo info = storeOf({});
  createPlyWriter((folder / "out.ply").string(), info, 10)->write(pointsOf(info, 10));
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(PlyWriter, RefusesAnotherNumberOfPointsThanItsHeaderSays) {
  const TempFolder folder;
  const StoreInfo info = storeOf({});
  const auto writer = createPlyWriter((folder / "out.ply").string(), info, 10);
  writer->write(pointsOf(info, 9));
  EXPECT_THROW(writer->finish(), Error);
}

}  // namespace
}  // namespace strata
