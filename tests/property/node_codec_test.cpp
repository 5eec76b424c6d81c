#include "io/node_codec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "core/error.h"

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

TEST(NodeCodec, GivesBackEveryPointBitForBit) {
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

TEST(NodeCodec, DrawnPositionsLieWithinHalfACellOfTheTrueOnes) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 60; ++round) {
    const StoreInfo info = storeInfo(random, 4 + static_cast<int>(random() % 30));
    const std::size_t count = 1 + random() % 500;
    const NodePoints points = randomPoints(random, info, count);
    const EncodedNode node = encodeNode(points, info);
    const NodeRecord record = recordOf(node, count);
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

TEST(NodeCodec, RefusesEveryTruncatedPayload) {
  std::mt19937_64 random(3);
  const StoreInfo info = storeInfo(random, 20);
  const NodePoints points = randomPoints(random, info, 40);
  const EncodedNode node = encodeNode(points, info);
  const NodeRecord record = recordOf(node, 40);
  for (std::size_t bytes = 0; bytes < node.payload.size(); ++bytes)
    EXPECT_THROW(decodeAll(record, info, std::span(node.payload).first(bytes)), Error) << bytes;
}

TEST(NodeCodec, RefusesEveryFlippedBit) {
  std::mt19937_64 random(4);
  const StoreInfo info = storeInfo(random, 20);
  const NodePoints points = randomPoints(random, info, 25);
  EncodedNode node = encodeNode(points, info);
  const NodeRecord record = recordOf(node, 25);
  for (std::size_t bit = 0; bit < node.payload.size() * 8; ++bit) {
    node.payload[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
    EXPECT_THROW(decodeAll(record, info, node.payload), Error) << "bit " << bit;
    node.payload[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
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
