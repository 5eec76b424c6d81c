#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <random>

#include "core/error.h"
#include "io/las/las_header.h"
#include "io/las/las_record.h"
#include "io/las/las_source.h"
#include "io/las/las_vlr.h"
#include "io/scan/scan_writer.h"
#include "tests/support/test_data.h"

namespace strata {
namespace {

std::vector<std::byte> randomBytes(std::mt19937_64& random, std::size_t count) {
  std::vector<std::byte> bytes(count);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

/// A store of `count` random points that came from a LAS file of this format, on a grid 1000 steps beside its own.
struct RandomStore {
  StoreInfo info;
  NodePoints points;
  Box bounds;
  std::vector<std::byte> records;  ///< as the file must have them
};

RandomStore randomStore(const LasRecordFormat& format, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  RandomStore store;
  LasMeta meta;
  meta.versionMinor = format.pointFormat >= 6 ? 4 : format.pointFormat >= 4 ? 3 : 2;
  meta.pointFormat = static_cast<std::uint8_t>(format.pointFormat);
  meta.recordBytes = format.recordBytes;
  meta.scale = {0.001, 0.01, 0.0025};
  meta.offset = {500000.0, 4000000.0, -100.0};
  meta.globalEncoding = 1;
  meta.vlrs = {{"someone", 5, "some data", {1, 2, 3}}};
  store.info.las = meta;
  store.info.layout = lasLayout(format, meta.vlrs);
  store.info.grid.scale = meta.scale;
  store.info.grid.offset = meta.offset - 1000.0 * meta.scale;

  std::vector<glm::ivec3> integers(count);
  for (glm::ivec3& xyz : integers)
    for (int axis = 0; axis < 3; ++axis) xyz[axis] = static_cast<std::int32_t>(random() % 2000000) - 1000000;
  // Unpacking random records gives attributes that the format can hold.
  store.records = randomBytes(random, count * format.recordBytes);
  for (std::size_t i = 0; i < count; ++i) std::memcpy(store.records.data() + i * format.recordBytes, &integers[i], 12);
  std::vector<glm::dvec3> positions(count);
  store.points.attributes.resize(count * lasStride(format));
  unpackLasRecords(format, meta.scale, store.records.data(), positions, store.points.attributes.data());
  for (int axis = 0; axis < 3; ++axis)
    for (const glm::ivec3& xyz : integers) store.points.grid[axis].push_back(xyz[axis] + std::int64_t{1000});
  for (const glm::dvec3& position : positions) store.bounds.add(meta.offset + position);
  return store;
}

/// The uncompressed records of the whole file.
std::vector<std::byte> recordsOf(const PointSource& source) {
  const LasMeta& meta = *source.info().las;
  const LasRecordFormat format{meta.pointFormat, meta.recordBytes};
  std::vector<std::byte> all, records;
  std::vector<glm::ivec3> integers;
  PointBlock block;
  for (std::size_t part = 0; part < source.partCount(); ++part) {
    const auto reader = source.openPart(part);
    while (reader->read(block, 777)) {
      integers.clear();
      for (const glm::dvec3& position : block.positions)
        integers.push_back(glm::ivec3(glm::round(position / meta.scale)));
      records.resize(block.count() * format.recordBytes);
      packLasRecords(format, integers, block.attributes.data(), records.data());
      all.insert(all.end(), records.begin(), records.end());
    }
  }
  return all;
}

class EveryFormat : public testing::TestWithParam<std::tuple<int, int, bool>> {};

TEST_P(EveryFormat, ComesBackBitForBit) {
  const auto [pointFormat, extra, compress] = GetParam();
  const LasRecordFormat format{pointFormat, static_cast<std::uint16_t>(lasFormatBytes(pointFormat) + extra)};
  const test::TempFolder folder;
  const std::string path = (folder / (compress ? "out.laz" : "out.las")).string();
  // Enough for two chunks of 50 000 points.
  const RandomStore store = randomStore(format, 60001, 7);
  const auto writer = createLasWriter(path, store.info, {store.points.count(), store.bounds}, {compress, {}});
  writer->write(store.points);
  EXPECT_FALSE(std::filesystem::exists(path));
  writer->finish();
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));

  const auto source = openLas(path, {});
  const SourceInfo& info = source->info();
  EXPECT_EQ(info.pointCount, store.points.count());
  EXPECT_EQ(info.las->scale, store.info.las->scale);
  EXPECT_EQ(info.las->offset, store.info.las->offset);
  EXPECT_EQ(info.las->versionMinor, store.info.las->versionMinor);
  ASSERT_EQ(info.las->vlrs.size(), 1u);
  EXPECT_EQ(info.las->vlrs[0].data, store.info.las->vlrs[0].data);
  EXPECT_LT(glm::length(info.bounds.min - store.bounds.min), 1e-6);
  EXPECT_LT(glm::length(info.bounds.max - store.bounds.max), 1e-6);
  EXPECT_TRUE(recordsOf(*source) == store.records);
}

INSTANTIATE_TEST_SUITE_P(LasWriter, EveryFormat,
                         testing::Combine(testing::Range(0, kLasLastFormat + 1), testing::Values(0, 5),
                                          testing::Bool()));

TEST(LasWriter, LeavesNothingBehindWhenItIsNotFinished) {
  const test::TempFolder folder;
  const RandomStore store = randomStore({3, 34}, 10, 1);
  for (const bool compress : {false, true}) {
    const auto writer = createLasWriter((folder / "out.las").string(), store.info, {10, store.bounds}, {compress, {}});
    writer->write(store.points);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(LasWriter, WritesFilesWithoutPoints) {
  const test::TempFolder folder;
  for (const bool compress : {false, true}) {
    const RandomStore store = randomStore({compress ? 7 : 3, static_cast<std::uint16_t>(compress ? 36 : 34)}, 0, 1);
    const std::string path = (folder / "out.las").string();
    createLasWriter(path, store.info, {0, store.bounds}, {compress, {}})->finish();
    EXPECT_EQ(openLas(path, {})->info().pointCount, 0u);
  }
}

Attribute column(std::string_view name, ScalarType type, std::uint16_t components = 1) {
  Attribute attribute;
  attribute.name = name;
  attribute.type = type;
  attribute.components = components;
  return attribute;
}

TEST(LasWriter, GivesOtherCloudsAFormatThatHoldsTheirAttributes) {
  const test::TempFolder folder;
  StoreInfo info;
  info.crs = "EPSG:25832";
  info.grid.scale = glm::dvec3(0.001);
  info.grid.offset = {1e6, 2e6, 3e6};
  info.layout =
      PointLayout({column(attribute::kNormal, ScalarType::f32, 3), column(attribute::kRgb, ScalarType::u16, 3),
                   column(attribute::kScanAngleRank, ScalarType::i8), column("extra:quality", ScalarType::f64)});
  NodePoints points;
  for (auto& axis : points.grid) axis = {0, 5000000000, 5000000001};
  for (int i = 0; i < 3; ++i) {
    const float normal[3] = {1.0f, 2.0f, static_cast<float>(i)};
    const std::uint16_t rgb[3] = {1, 2, static_cast<std::uint16_t>(i)};
    const std::int8_t rank = static_cast<std::int8_t>(-10 * i);
    const double quality = i * 0.5;
    const std::size_t at = points.attributes.size();
    points.attributes.resize(at + info.layout.stride());
    std::memcpy(&points.attributes[at], normal, 12);
    std::memcpy(&points.attributes[at + 12], rgb, 6);
    std::memcpy(&points.attributes[at + 18], &rank, 1);
    std::memcpy(&points.attributes[at + 19], &quality, 8);
  }
  const Box wide{info.grid.offset, info.grid.offset + 5000000.001};
  const std::string path = (folder / "out.laz").string();
  EXPECT_THROW(createLasWriter(path, info, {3, wide}, {true, {}}), Error);

  for (auto& axis : points.grid) axis = {4000000000, 5000000000, 5000000001};
  const Box bounds{info.grid.offset + 4000000.0, info.grid.offset + 5000000.001};
  const auto writer = createLasWriter(path, info, {3, bounds}, {true, {}});
  writer->write(points);
  writer->finish();

  const auto source = openLas(path, {});
  EXPECT_EQ(source->info().format, "LAZ 1.4 format 7");
  EXPECT_EQ(source->info().crs, "EPSG:25832");
  PointBlock block;
  ASSERT_TRUE(source->openPart(0)->read(block, 10));
  ASSERT_EQ(block.count(), 3u);
  const PointLayout& layout = source->info().layout;
  const auto field = [&](std::size_t point, std::string_view name) {
    return block.attributes.data() + point * layout.stride() +
           layout.offset(static_cast<std::size_t>(layout.find(name)));
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 world = source->info().origin + block.positions[i];
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(world[axis], info.grid.offset[axis] + 0.001 * static_cast<double>(points.grid[axis][i]), 1e-6);
    EXPECT_EQ(std::memcmp(field(i, "rgb"), &points.attributes[i * info.layout.stride() + 12], 6), 0);
    EXPECT_EQ(std::memcmp(field(i, "extra:normal[0]"), &points.attributes[i * info.layout.stride()], 12), 0);
    EXPECT_EQ(std::memcmp(field(i, "extra:quality"), &points.attributes[i * info.layout.stride() + 19], 8), 0);
    std::int16_t angle = 0;
    std::memcpy(&angle, field(i, "scan_angle"), 2);
    EXPECT_EQ(angle, static_cast<std::int16_t>(std::lround(-10.0 * static_cast<double>(i) / 0.006)));
  }
}

TEST(LasWriter, WritesTheFormatThatIsAskedFor) {
  const test::TempFolder folder;
  StoreInfo info;
  info.grid.scale = glm::dvec3(0.001);
  info.layout = PointLayout({column(attribute::kRgb, ScalarType::u16, 3),
                             column(attribute::kIntensity, ScalarType::u16), column(attribute::kNir, ScalarType::u16)});
  info.ranges.resize(3);
  NodePoints points;
  for (auto& axis : points.grid) axis = {1, 2, 3};
  for (int i = 0; i < 3 * static_cast<int>(info.layout.stride()); ++i)
    points.attributes.push_back(static_cast<std::byte>(i));
  const Box bounds{glm::dvec3(0.001), glm::dvec3(0.003)};
  for (const int format : {0, 1, 2, 3, 6, 7, 8}) {
    const std::string path = (folder / ("out" + std::to_string(format) + ".las")).string();
    const auto writer = createLasWriter(path, info, {3, bounds}, {false, format});
    writer->write(points);
    writer->finish();
    const auto source = openLas(path, {});
    EXPECT_EQ(source->info().las->pointFormat, format);
    PointBlock block;
    ASSERT_TRUE(source->openPart(0)->read(block, 10));
    const PointLayout& layout = source->info().layout;
    for (std::size_t a = 0; a < 3; ++a) {
      const Attribute& attribute = info.layout.attributes()[a];
      int place = layout.find(attribute.name);
      if (place < 0) place = layout.find("extra:" + attribute.name + (attribute.components > 1 ? "[0]" : ""));
      ASSERT_GE(place, 0) << attribute.name << " in format " << format;
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(std::memcmp(block.attributes.data() + i * layout.stride() + layout.offset(std::size_t(place)),
                              &points.attributes[i * info.layout.stride() + info.layout.offset(a)], attribute.bytes()),
                  0);
    }
  }
  info.layout = PointLayout({column(attribute::kClassification, ScalarType::u8)});
  info.ranges = {{0, 32, 0, 32}};
  EXPECT_THROW(createLasWriter((folder / "no.las").string(), info, {3, bounds}, {false, 2}), Error);
}

TEST(LasWriter, LeavesTheSourcesFormatWhenValuesDoNotFitIt) {
  const test::TempFolder folder;
  RandomStore store = randomStore({3, 34}, 5, 3);
  store.info.ranges.resize(store.info.layout.attributes().size());
  store.info.ranges[static_cast<std::size_t>(store.info.layout.find(attribute::kClassification))].max = 64;
  const std::string path = (folder / "out.las").string();
  const auto writer = createLasWriter(path, store.info, {5, store.bounds}, {false, {}});
  writer->write(store.points);
  writer->finish();
  EXPECT_EQ(openLas(path, {})->info().las->pointFormat, 7);
}

std::string readFailure(const std::string& path, std::uint64_t& points, bool skipDamaged) {
  SourceOptions options;
  options.skipDamaged = skipDamaged;
  points = 0;
  try {
    const auto source = openLas(path, options);
    PointBlock block;
    for (std::size_t part = 0; part < source->partCount(); ++part) {
      const auto reader = source->openPart(part);
      while (reader->read(block, 1000)) points += block.count();
    }
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(DamagedLaz, IsReportedAndSkippedWhereTheUserWantsIt) {
  const test::TempFolder folder;
  const std::string path = (folder / "out.laz").string();
  for (const int pointFormat : {1, 6}) {
    const LasRecordFormat format{pointFormat, lasFormatBytes(pointFormat)};
    const RandomStore store = randomStore(format, 120000, 5);
    const auto writer = createLasWriter(path, store.info, {store.points.count(), store.bounds}, {true, {}});
    writer->write(store.points);
    writer->finish();
    const auto size = std::filesystem::file_size(path);
    std::uint64_t points = 0;
    EXPECT_EQ(readFailure(path, points, false), "");
    EXPECT_EQ(points, 120000u);

    std::filesystem::resize_file(path, size * 7 / 10);
    EXPECT_NE(readFailure(path, points, false).find("the file ends early"), std::string::npos);
    EXPECT_EQ(points, 0u);
    EXPECT_EQ(readFailure(path, points, true), "");
    EXPECT_GE(points, 50000u);
    EXPECT_LT(points, 120000u);
  }
}

TEST(DamagedLaz, WithBytesFlippedIsReadOrRefused) {
  const test::TempFolder folder;
  std::mt19937_64 random(11);
  for (const int pointFormat : {3, 8}) {
    const LasRecordFormat format{pointFormat, static_cast<std::uint16_t>(lasFormatBytes(pointFormat) + 3)};
    const RandomStore store = randomStore(format, 500, 5);
    const std::string path = (folder / "sound.laz").string(), damaged = (folder / "damaged.laz").string();
    const auto writer = createLasWriter(path, store.info, {store.points.count(), store.bounds}, {true, {}});
    writer->write(store.points);
    writer->finish();
    std::ifstream in(path, std::ios::binary);
    const std::string sound((std::istreambuf_iterator<char>(in)), {});
    for (int round = 0; round < 300; ++round) {
      std::string bytes = sound;
      for (int flips = 1 + static_cast<int>(random() % 4); flips > 0; --flips) {
        // Half of the changes are in the header, its VLRs and the chunk table.
        const std::size_t at = random() % 3 == 0   ? random() % 900
                               : random() % 3 == 0 ? bytes.size() - 1 - random() % 40
                                                   : random() % bytes.size();
        bytes[at] = static_cast<char>(random());
      }
      std::ofstream(damaged, std::ios::binary) << bytes;
      std::uint64_t points = 0;
      const std::string failure = readFailure(damaged, points, round % 2 == 0);
      EXPECT_EQ(failure.find('\n'), std::string::npos) << failure;
    }
  }
}

}  // namespace
}  // namespace strata
