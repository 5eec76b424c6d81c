#include "io/store/node_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <string>

#include "core/error.h"
#include "tests/support/sign_payload.h"

namespace strata {
namespace {

StoreInfo storeInfo(std::mt19937_64& random, int cubeBits) {
  std::vector<Attribute> attributes;
  const auto maybe = [&](std::string_view name, ScalarType type, std::uint16_t components) {
    if (random() % 3 != 0) attributes.push_back({std::string(name), type, components, "", 1.0, 0.0});
  };
  maybe(attribute::kGpsTime, ScalarType::f64, 1);
  maybe(attribute::kIntensity, ScalarType::u16, 1);
  maybe(attribute::kRgb, ScalarType::u16, 3);
  maybe(attribute::kClassification, ScalarType::u8, 1);
  maybe("extra:wide", ScalarType::u8, 29);
  StoreInfo info;
  info.layout = PointLayout(attributes);
  info.cubeBits = cubeBits;
  info.colourShift = random() % 2 == 0 ? 8 : 0;
  info.grid.scale = glm::dvec3(0.001);
  info.grid.offset = glm::dvec3(500000.0, 5400000.0, 100.0);
  return info;
}

NodePoints randomPoints(std::mt19937_64& random, const StoreInfo& info, std::size_t count) {
  NodePoints points;
  const std::uint64_t extent = std::uint64_t{1} << info.cubeBits;
  for (auto& axis : points.grid) {
    const std::uint64_t width = std::uint64_t{1} << (random() % static_cast<std::uint64_t>(info.cubeBits + 1));
    const std::uint64_t start = random() % (extent - width + 1);
    for (std::size_t i = 0; i < count; ++i) axis.push_back(static_cast<std::int64_t>(start + random() % width));
  }
  points.attributes.resize(count * info.layout.stride());
  const int style = static_cast<int>(random() % 3);  // constant, small values, noise
  for (std::byte& b : points.attributes)
    b = static_cast<std::byte>(style == 0 ? 7 : style == 1 ? random() % 4 : random() & 255);
  return points;
}

NodeRecord recordOf(const EncodedNode& node, std::size_t count) {
  NodeRecord record{};
  record.key = 1;
  record.pointCount = static_cast<std::uint32_t>(count);
  record.headBytes = node.headBytes;
  record.headChecksum = node.headChecksum;
  record.payloadBytes = static_cast<std::uint32_t>(node.payload.size());
  std::copy(node.drawBytes, node.drawBytes + 3, record.drawBytes);
  return record;
}

/// A few rising counts that end at `count`.
std::vector<std::uint32_t> randomLevels(std::mt19937_64& random, std::size_t count) {
  std::vector<std::uint32_t> levels;
  for (std::size_t end = random() % 4; end < count; end += 1 + random() % (3 * end + 2))
    levels.push_back(static_cast<std::uint32_t>(end));
  levels.push_back(static_cast<std::uint32_t>(count));
  return levels;
}

/// Every point with its attributes as one string of bytes; the strings of one level are sorted.
std::vector<std::string> pointsByLevel(const NodePoints& points, std::size_t stride,
                                       const std::vector<std::uint32_t>& levels) {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < points.count(); ++i) {
    std::string point;
    for (const auto& axis : points.grid) point.append(reinterpret_cast<const char*>(&axis[i]), sizeof axis[i]);
    point.append(reinterpret_cast<const char*>(points.attributes.data()) + i * stride, stride);
    all.push_back(std::move(point));
  }
  std::size_t first = 0;
  for (const std::uint32_t end : levels) {
    std::sort(all.begin() + static_cast<std::ptrdiff_t>(first), all.begin() + static_cast<std::ptrdiff_t>(end));
    first = end;
  }
  return all;
}

TEST(NodeCodec, GivesBackEveryPointBitForBitInTheOrderGivenWhereThereAreNoLevels) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 120; ++round) {
    const StoreInfo info = storeInfo(random, 1 + static_cast<int>(random() % 52));
    const std::size_t count = round % 10 == 0 ? 1 + random() % 30000 : random() % 300;
    const NodePoints points = randomPoints(random, info, count);
    const EncodedNode node = encodeNode(points, info);
    const NodePoints decoded = decodeAll(recordOf(node, count), info, node.payload);
    for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(points.grid[axis], decoded.grid[axis]) << "round " << round;
    ASSERT_EQ(points.attributes, decoded.attributes) << "round " << round;
  }
}

TEST(NodeCodec, GivesBackThePointsOfEveryLevelBitForBit) {
  std::mt19937_64 random(6);
  EncodeScratch scratch;
  for (int round = 0; round < 200; ++round) {
    StoreInfo info = storeInfo(random, 1 + static_cast<int>(random() % 52));
    if (round % 3 == 0) info.grid.scale = glm::dvec3(0.01, 0.001, 1e-7);
    const std::size_t count = round % 10 == 0 ? 1 + random() % 30000 : random() % 300;
    NodePoints points = randomPoints(random, info, count);
    if (round % 5 == 0)  // descending, with many copies
      for (auto& axis : points.grid) {
        for (std::int64_t& v : axis) v = v >> 3 << 3;
        std::sort(axis.rbegin(), axis.rend());
      }
    points.levels = randomLevels(random, count);
    const EncodedNode node = encodeNode(points, info, scratch);
    ASSERT_EQ(node.payload, encodeNode(points, info).payload) << "round " << round;  // the scratch leaves no trace
    const NodePoints decoded = decodeAll(recordOf(node, count), info, node.payload);
    ASSERT_EQ(pointsByLevel(decoded, info.layout.stride(), points.levels),
              pointsByLevel(points, info.layout.stride(), points.levels))
        << "round " << round;
  }
}

TEST(NodeCodec, KeepsColoursBesideOtherDrawnOnes) {
  std::mt19937_64 random(7);
  for (const int style : {0, 1, 2}) {  // 16 bits; 8 bits in both bytes; 8 bits in the upper byte
    StoreInfo info;
    info.layout = PointLayout({{std::string(attribute::kRgb), ScalarType::u16, 3, "", 1.0, 0.0}});
    info.colourShift = 8;
    info.cubeBits = 12;
    NodePoints points = randomPoints(random, info, 3000);
    std::vector<std::uint16_t> rgb;
    for (int i = 0; i < 9000; ++i)
      rgb.push_back(static_cast<std::uint16_t>(style == 0   ? random()
                                               : style == 1 ? 257 * (random() & 255)
                                                            : (random() & 255) << 8));
    std::memcpy(points.attributes.data(), rgb.data(), points.attributes.size());
    for (int i = 0; i < 3000; ++i) points.drawColours.push_back(static_cast<std::uint32_t>(random() & 0xffffff));
    const EncodedNode node = encodeNode(points, info);
    EXPECT_EQ(decodeAll(recordOf(node, 3000), info, node.payload).attributes, points.attributes) << style;
    NodeData drawn;
    decodeForDrawing(recordOf(node, 3000), info, node.payload, Precision::full30, drawn);
    for (std::size_t i = 0; i < 3000; ++i) ASSERT_EQ(drawn.colour[i], points.drawColours[i] | 0xff000000u) << style;
  }
}

TEST(NodeCodec, SpendsLessOnSortedPointsOfASurfaceThanOnTheirBits) {
  std::mt19937_64 random(8);
  StoreInfo info;
  info.cubeBits = 20;
  NodePoints points;
  const std::size_t count = 40000;
  for (std::size_t i = 0; i < count; ++i) {
    points.grid[0].push_back(static_cast<std::int64_t>(random() % 100000));
    points.grid[1].push_back(static_cast<std::int64_t>(random() % 100000));
    points.grid[2].push_back(points.grid[0].back() / 3 + points.grid[1].back() / 4 + static_cast<int>(random() % 8));
  }
  const std::size_t unsorted = encodeNode(points, info).payload.size();
  points.levels = {count};
  EXPECT_LT(encodeNode(points, info).payload.size() + count * 2, unsorted);
}

TEST(NodeCodec, DrawnPositionsLieWithinHalfACellOfTheTrueOnes) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 60; ++round) {
    const StoreInfo info = storeInfo(random, 4 + static_cast<int>(random() % 30));
    const std::size_t count = 1 + random() % 500;
    NodePoints points = randomPoints(random, info, count);
    if (round % 2 == 0) points.levels = randomLevels(random, count);
    const EncodedNode node = encodeNode(points, info);
    const NodeRecord record = recordOf(node, count);
    points = decodeAll(record, info, node.payload);
    for (int planes = 1; planes <= 3; ++planes) {
      const auto precision = static_cast<Precision>(planes);
      NodeData data;
      decodeForDrawing(record, info, std::span(node.payload).first(drawBytes(record, precision)), precision, data);
      ASSERT_EQ(data.pointCount(), count);
      ASSERT_EQ(data.loadedPlanes(), planes);
      for (const Batch& batch : data.batches)
        for (std::uint32_t i = batch.firstPoint; i < batch.firstPoint + batch.pointCount; ++i) {
          const glm::dvec3 shown = pointPosition(data, batch, i, precision);
          for (int axis = 0; axis < 3; ++axis) {
            const double truth = info.grid.offset[axis] + 0.001 * static_cast<double>(points.grid[axis][i]);
            const double cell = batch.boxSize[axis] / std::ldexp(1.0, 10 * planes);
            const double allowed = (batch.bits[axis] > 10 * planes ? 0.5 * cell : 0.0) + 1e-8;
            ASSERT_NEAR(shown[axis], truth, allowed) << "axis " << axis << " planes " << planes;
          }
        }
    }
  }
}

TEST(NodeCodec, ShowsReturnNumbersAndNormalsWhereTheBytesHoldThem) {
  std::mt19937_64 random(9);
  StoreInfo info = storeInfo(random, 20);
  info.layout = PointLayout({{std::string(attribute::kReturnNumber), ScalarType::u8, 1, {}},
                             {std::string(attribute::kNormal), ScalarType::f32, 3, {}}});
  NodePoints points = randomPoints(random, info, 3);
  const float normals[3][3] = {{0.0f, 0.0f, 2.0f}, {-1.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}};
  for (std::size_t i = 0; i < 3; ++i) {
    points.attributes[i * 13] = static_cast<std::byte>(i + 1);
    std::memcpy(&points.attributes[i * 13 + 1], normals[i], 12);
  }
  const EncodedNode node = encodeNode(points, info);
  const NodeRecord record = recordOf(node, 3);
  NodeData data;
  decodeForDrawing(record, info, node.payload, Precision::full30, data);
  EXPECT_EQ(data.returnNumber, (std::vector<std::uint8_t>{1, 2, 3}));
  EXPECT_EQ(data.normal, (std::vector<std::uint32_t>{0x7f0000u, 0x000081u, 0u}));
  decodeForDrawing(record, info, std::span(node.payload).first(drawBytes(record, Precision::full30)), Precision::full30,
                   data);
  EXPECT_TRUE(data.returnNumber.empty());
  EXPECT_TRUE(data.normal.empty());
}

TEST(NodeCodec, RefusesEveryTruncatedPayload) {
  std::mt19937_64 random(3);
  const StoreInfo info = storeInfo(random, 20);
  NodePoints points = randomPoints(random, info, 40);
  points.levels = {1, 9, 40};
  const EncodedNode node = encodeNode(points, info);
  const NodeRecord record = recordOf(node, 40);
  for (std::size_t bytes = 0; bytes < node.payload.size(); ++bytes)
    EXPECT_THROW(decodeAll(record, info, std::span(node.payload).first(bytes)), Error) << bytes;
}

TEST(NodeCodec, RefusesEveryFlippedBit) {
  std::mt19937_64 random(4);
  const StoreInfo info = storeInfo(random, 20);
  NodePoints points = randomPoints(random, info, 25);
  points.levels = {3, 25};
  EncodedNode node = encodeNode(points, info);
  const NodeRecord record = recordOf(node, 25);
  for (std::size_t bit = 0; bit < node.payload.size() * 8; ++bit) {
    node.payload[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
    EXPECT_THROW(decodeAll(record, info, node.payload), Error) << "bit " << bit;
    node.payload[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
  }
}

TEST(NodeCodec, FlippedBitsUnderRightChecksumsNeverCrash) {
  std::mt19937_64 random(9);
  for (int round = 0; round < 30; ++round) {
    const StoreInfo info = storeInfo(random, 1 + static_cast<int>(random() % 40));
    const std::size_t count = 1 + random() % 400;
    NodePoints points = randomPoints(random, info, count);
    points.levels = randomLevels(random, count);
    const EncodedNode node = encodeNode(points, info);
    for (int flip = 0; flip < 300; ++flip) {
      EncodedNode bad = node;
      for (std::uint64_t flips = 1 + random() % 3; flips > 0; --flips)
        bad.payload[random() % bad.payload.size()] ^= static_cast<std::byte>(1u << (random() % 8));
      test::signPayload(bad.payload, bad.headBytes);
      bad.headChecksum = checksum(std::span(bad.payload).first(bad.headBytes));
      NodeData drawn;
      try {
        decodeForDrawing(recordOf(bad, count), info, bad.payload, Precision::full30, drawn);
        decodeAll(recordOf(bad, count), info, bad.payload);
      } catch (const Error&) {
      }
    }
  }
}

TEST(NodeCodec, ANodeWithoutPointsSurvives) {
  std::mt19937_64 random(5);
  const StoreInfo info = storeInfo(random, 12);
  const EncodedNode node = encodeNode(NodePoints{}, info);
  EXPECT_EQ(decodeAll(recordOf(node, 0), info, node.payload).count(), 0u);
}

}  // namespace
}  // namespace strata
