#pragma once
// Small stores made in memory, and byte sources that misbehave, for the tests of lod.

#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/view.h"
#include "io/store/node_codec.h"
#include "io/store/store.h"

namespace strata::test {

/// Bytes in memory. Each read first calls `beforeRead` with the number of the read, from 0; it may wait or throw.
class MemoryBytes final : public ByteSource {
 public:
  explicit MemoryBytes(std::vector<std::byte> bytes, std::function<void(std::uint64_t)> beforeRead = {})
      : bytes_(std::move(bytes)), beforeRead_(std::move(beforeRead)) {}

  std::uint64_t size() const override { return bytes_.size(); }
  const std::string& name() const override { return name_; }
  void read(std::uint64_t offset, std::span<std::byte> out) const override {
    const std::uint64_t call = calls_.fetch_add(1);
    if (beforeRead_) beforeRead_(call);
    if (offset > bytes_.size() || out.size() > bytes_.size() - offset) throw Error(name_, "truncated read");
    std::memcpy(out.data(), bytes_.data() + offset, out.size());
  }

 private:
  std::vector<std::byte> bytes_;
  std::function<void(std::uint64_t)> beforeRead_;
  std::string name_ = "memory/points.bin";
  mutable std::atomic<std::uint64_t> calls_{0};
};

struct TerrainOptions {
  int levels = 4;     ///< levels of a full quadtree over the ground
  int side = 16;      ///< a node keeps side x side points
  int cubeBits = 20;  ///< the cube spans 2^cubeBits millimetres
  bool normals = false;
};

/// The hierarchy, and the payloads if asked for, of a flat and slightly rough ground: a quadtree with all its points in
/// the lowest octants.
struct Terrain {
  StoreInfo info;
  Hierarchy hierarchy;
  std::vector<std::byte> points;
};

inline StoreInfo terrainInfo(const TerrainOptions& options) {
  StoreInfo info;
  info.program = "strata test";
  info.grid.offset = {400000.0, 5600000.0, 100.0};
  info.cubeBits = options.cubeBits;
  info.levels = options.levels;
  std::vector<Attribute> attributes{{std::string(attribute::kRgb), ScalarType::u16, 3, "", 1.0, 0.0},
                                    {std::string(attribute::kIntensity), ScalarType::u16, 1, "", 1.0, 0.0}};
  if (options.normals)
    attributes.push_back({std::string(attribute::kNormalOctahedral), ScalarType::u8, 2, "", 1.0, 0.0});
  info.ranges.resize(attributes.size());
  info.layout = PointLayout(std::move(attributes));
  info.colourShift = 8;
  info.bounds = info.rootCube();
  return info;
}

/// The node's points on the grid of `info`, shuffled, so that every prefix is an even subsample.
inline NodePoints terrainPoints(NodeKey key, const StoreInfo& info, const TerrainOptions& options) {
  std::mt19937_64 random(key.code);
  const Box cube = nodeCube(key, info.rootCube());
  const glm::dvec3 corner = glm::round((cube.min - info.grid.offset) / info.grid.scale);
  const double size = std::round(cube.size().x / info.grid.scale.x);
  NodePoints points;
  std::vector<std::pair<int, int>> cells;
  for (int y = 0; y < options.side; ++y)
    for (int x = 0; x < options.side; ++x) cells.emplace_back(x, y);
  for (std::size_t i = cells.size(); i > 1; --i) std::swap(cells[i - 1], cells[random() % i]);
  for (const auto& [x, y] : cells) {
    const double step = size / options.side;
    const auto jitter = [&] { return 0.1 + 0.8 * static_cast<double>(random() % 1024) / 1024.0; };
    points.grid[0].push_back(static_cast<std::int64_t>(corner.x + (x + jitter()) * step));
    points.grid[1].push_back(static_cast<std::int64_t>(corner.y + (y + jitter()) * step));
    points.grid[2].push_back(static_cast<std::int64_t>(random() % 64));
  }
  points.attributes.resize(points.count() * info.layout.stride());
  for (std::byte& b : points.attributes) b = static_cast<std::byte>(random());
  return points;
}

inline NodeRecord terrainRecord(NodeKey key, const StoreInfo& info, const TerrainOptions& options) {
  const Box cube = nodeCube(key, info.rootCube());
  NodeRecord record{};
  record.key = key.code;
  record.contourClass = static_cast<std::uint8_t>(ContourClass::planar);
  record.pointCount = static_cast<std::uint32_t>(options.side * options.side);
  record.prefixes = 1;
  record.prefix[0] = record.pointCount;
  record.spacing = static_cast<float>(cube.size().x / options.side);
  record.centre[0] = cube.centre().x;
  record.centre[1] = cube.centre().y;
  record.centre[2] = info.grid.offset.z + 0.032;
  record.halfAxis[0][0] = static_cast<float>(cube.size().x / 2);
  record.halfAxis[1][1] = static_cast<float>(cube.size().y / 2);
  record.halfAxis[2][2] = 0.032f;
  return record;
}

inline Terrain makeTerrain(const TerrainOptions& options, bool withPayloads) {
  Terrain terrain;
  terrain.info = terrainInfo(options);
  std::vector<NodeKey> keys{NodeKey{}};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    NodeRecord record = terrainRecord(keys[i], terrain.info, options);
    if (keys[i].level() + 1 < options.levels) {
      record.firstChild = static_cast<std::uint32_t>(keys.size());
      for (const int octant : {0, 2, 4, 6}) {
        record.childMask = static_cast<std::uint8_t>(record.childMask | 1 << octant);
        keys.push_back(keys[i].child(octant));
      }
    }
    if (withPayloads) {
      const EncodedNode encoded = encodeNode(terrainPoints(keys[i], terrain.info, options), terrain.info);
      record.offset = terrain.points.size();
      record.payloadBytes = static_cast<std::uint32_t>(encoded.payload.size());
      record.headBytes = encoded.headBytes;
      record.headChecksum = encoded.headChecksum;
      std::memcpy(record.drawBytes, encoded.drawBytes, sizeof record.drawBytes);
      terrain.points.insert(terrain.points.end(), encoded.payload.begin(), encoded.payload.end());
    }
    terrain.hierarchy.nodes.push_back(record);
    terrain.info.points += record.pointCount;
  }
  terrain.info.nodes = terrain.hierarchy.nodes.size();
  return terrain;
}

/// Adds a slice below the leaf `index`, with other points of the same cell. Its record comes last, so the keys of the
/// records no longer ascend.
inline Terrain addSlice(Terrain terrain, std::uint32_t index) {
  NodeRecord slice = terrain.hierarchy.nodes[index];
  if (!terrain.points.empty()) {
    NodePoints points = readAll(
        *std::make_shared<Store>(terrain.info, terrain.hierarchy, std::make_unique<MemoryBytes>(terrain.points)),
        index);
    for (std::int64_t& z : points.grid[2]) z += 100;
    const EncodedNode encoded = encodeNode(points, terrain.info);
    slice.offset = terrain.points.size();
    slice.payloadBytes = static_cast<std::uint32_t>(encoded.payload.size());
    slice.headBytes = encoded.headBytes;
    slice.headChecksum = encoded.headChecksum;
    std::memcpy(slice.drawBytes, encoded.drawBytes, sizeof slice.drawBytes);
    terrain.points.insert(terrain.points.end(), encoded.payload.begin(), encoded.payload.end());
  }
  NodeRecord& first = terrain.hierarchy.nodes[index];
  first.firstChild = static_cast<std::uint32_t>(terrain.hierarchy.nodes.size());
  first.childMask = first.sliced = 1;
  terrain.hierarchy.nodes.push_back(slice);
  terrain.info.points += slice.pointCount;
  terrain.info.nodes = terrain.hierarchy.nodes.size();
  return terrain;
}

/// The terrain as a store; `beforeRead` as in MemoryBytes.
inline std::shared_ptr<const Store> makeStore(const Terrain& terrain,
                                              std::function<void(std::uint64_t)> beforeRead = {}) {
  return std::make_shared<Store>(terrain.info, terrain.hierarchy,
                                 std::make_unique<MemoryBytes>(terrain.points, std::move(beforeRead)));
}

/// The index of each node's parent, found by a walk down, which is not how indexHierarchy() finds it.
inline std::vector<std::uint32_t> parentsOf(const Hierarchy& hierarchy) {
  std::vector<std::uint32_t> parents(hierarchy.nodes.size(), 0xffffffffu);
  for (std::uint32_t i = 0; i < hierarchy.nodes.size(); ++i)
    for (int k = 0; k < std::popcount(hierarchy.nodes[i].childMask); ++k)
      parents[hierarchy.nodes[i].firstChild + static_cast<std::uint32_t>(k)] = i;
  return parents;
}

/// A view down onto the terrain, from `height` metres above (x, y), which are fractions of the cube.
inline View viewOfTerrain(const StoreInfo& info, double x, double y, double height, int width = 640,
                          int heightPx = 480) {
  const Box cube = info.rootCube();
  View view;
  view.eye = cube.min + glm::dvec3(x * cube.size().x, y * cube.size().y, height);
  view.target = view.eye + glm::dvec3(0.0, 0.5 * height, -height);
  view.width = width;
  view.height = heightPx;
  return view;
}

}  // namespace strata::test
