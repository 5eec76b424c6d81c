#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <random>

#include "converter/convert.h"
#include "converter/journal/build_folder.h"
#include "core/error.h"
#include "io/open_scans.h"
#include "io/store/node_codec.h"
#include "io/store/store_files.h"
#include "io/store/verify.h"
#include "tests/support/evenness.h"
#include "tests/support/test_data.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

ConvertReport convertTo(const fs::path& store, const std::vector<std::string>& inputs, int threads = 2,
                        std::uint32_t nodePoints = 4096) {
  ConvertOptions options;
  options.inputs = inputs;
  options.output = store.string();
  options.threads = threads;
  options.nodePoints = nodePoints;
  options.memoryBytes = kLeastMemoryBytes;
  return convert(options, ConvertControl{});
}

std::string bytesOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Every point as grid integers and attribute bytes, sorted.
std::vector<std::string> sortedPoints(const Store& store) {
  std::vector<std::string> all;
  const std::size_t stride = store.info().layout.stride();
  for (std::uint32_t n = 0; n < store.hierarchy().nodes.size(); ++n) {
    const NodePoints points = readAll(store, n);
    for (std::size_t i = 0; i < points.count(); ++i) {
      std::string one(24 + stride, '\0');
      for (std::size_t axis = 0; axis < 3; ++axis) std::memcpy(one.data() + 8 * axis, &points.grid[axis][i], 8);
      std::copy_n(reinterpret_cast<const char*>(points.attributes.data()) + i * stride, stride, one.data() + 24);
      all.push_back(std::move(one));
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// The same, straight from the source.
std::vector<std::string> sortedSourcePoints(const std::string& input, const StoreInfo& info) {
  std::vector<std::string> all;
  const std::size_t stride = info.layout.stride();
  for (const auto& source : openScans({input}, {}))
    for (std::size_t part = 0; part < source->partCount(); ++part) {
      const auto reader = source->openPart(part);
      PointBlock block;
      while (reader->read(block, 10000))
        for (std::size_t i = 0; i < block.count(); ++i) {
          std::string one(24 + stride, '\0');
          const glm::dvec3 world = block.positions[i] + (source->info().origin - info.grid.offset);
          for (int axis = 0; axis < 3; ++axis) {
            const std::int64_t grid = std::llround(world[axis] / info.grid.scale[axis]);
            std::memcpy(one.data() + 8 * axis, &grid, 8);
          }
          std::copy_n(reinterpret_cast<const char*>(block.attributes.data()) + i * stride, stride, one.data() + 24);
          all.push_back(std::move(one));
        }
    }
  std::sort(all.begin(), all.end());
  return all;
}

class EveryShape : public testing::TestWithParam<const char*> {};

TEST_P(EveryShape, KeepsEverySourcePointExactlyOnceInASoundStore) {
  const test::TempFolder folder;
  const std::string input = std::string("synthetic:") + GetParam() + "?points=150000&seed=5";
  convertTo(folder / "a.strata", {input});
  const Store store((folder / "a.strata").string());
  const VerifyReport report = verifyStore(store);
  EXPECT_TRUE(report.problems.empty()) << report.problems.front();
  EXPECT_EQ(sortedPoints(store), sortedSourcePoints(input, store.info()));
}

TEST_P(EveryShape, GivesTheSameBytesForOneTwoAndEightThreads) {
  const test::TempFolder folder;
  const std::vector<std::string> inputs{std::string("synthetic:") + GetParam() + "?points=300000&seed=2"};
  for (const int threads : {1, 2, 8}) convertTo(folder / ("t" + std::to_string(threads)), inputs, threads);
  for (const char* file : {kInfoFile, kHierarchyFile, kPointsFile}) {
    EXPECT_EQ(bytesOf(folder / "t1" / file), bytesOf(folder / "t2" / file)) << file;
    EXPECT_EQ(bytesOf(folder / "t1" / file), bytesOf(folder / "t8" / file)) << file;
  }
}

TEST_P(EveryShape, InnerNodesAreFullAndLeavesHoldNoMoreThanTheCapacity) {
  const test::TempFolder folder;
  convertTo(folder / "a.strata", {std::string("synthetic:") + GetParam() + "?points=100000"});
  const Store store((folder / "a.strata").string());
  for (std::uint32_t n = 0; n < store.hierarchy().nodes.size(); ++n) {
    const NodeRecord& node = store.hierarchy().nodes[n];
    if (node.childMask != 0) {
      EXPECT_EQ(node.pointCount, 4096u) << NodeKey{node.key}.text();
    } else if (node.pointCount > 4096u) {  // only copies of one point cannot be divided
      const NodePoints points = readAll(store, n);
      for (const auto& axis : points.grid)
        EXPECT_EQ(*std::min_element(axis.begin(), axis.end()), *std::max_element(axis.begin(), axis.end()));
    }
  }
}

TEST_P(EveryShape, EveryPointLiesInItsNodesCubeAndInTheContoursOfItAndAllAbove) {
  const test::TempFolder folder;
  convertTo(folder / "a.strata", {std::string("synthetic:") + GetParam() + "?points=60000&seed=4"});
  const Store store((folder / "a.strata").string());
  const std::vector<NodeRecord>& nodes = store.hierarchy().nodes;
  std::map<std::uint64_t, const NodeRecord*> byKey;
  for (const NodeRecord& node : nodes) byKey[node.key] = &node;
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    const NodePoints points = readAll(store, n);
    const int bits = store.info().cubeBits - NodeKey{nodes[n].key}.level();
    for (std::size_t i = 0; i < points.count(); ++i) {
      std::uint64_t code = 1;
      for (int level = 1; level <= NodeKey{nodes[n].key}.level(); ++level)
        for (const auto& axis : points.grid)
          code = code << 1 | (static_cast<std::uint64_t>(axis[i]) >> (store.info().cubeBits - level) & 1);
      ASSERT_EQ(code, nodes[n].key) << "of " << bits << " bits";
      const glm::dvec3 world =
          store.info().grid.offset +
          store.info().grid.scale * glm::dvec3(points.grid[0][i], points.grid[1][i], points.grid[2][i]);
      for (std::uint64_t key = nodes[n].key; key != 0; key >>= 3) {
        const NodeRecord& node = *byKey.at(key);
        const glm::dvec3 apart = world - glm::dvec3(node.centre[0], node.centre[1], node.centre[2]);
        for (const auto& h : node.halfAxis) {
          const glm::dvec3 axis(h[0], h[1], h[2]);
          ASSERT_LE(std::abs(glm::dot(apart, axis)), glm::dot(axis, axis) * (1.0 + 1e-5) + 1e-5 * glm::length(axis))
              << NodeKey{nodes[n].key}.text() << " in " << NodeKey{key}.text();
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, EveryShape,
                         testing::Values("plane", "room", "city", "terrain", "stack", "sphere", "degenerate"),
                         [](const auto& shape) { return std::string(shape.param); });

TEST(Converter, EveryPrefixOfAStoredDensePlaneIsMoreEvenThanRandomPoints) {
  const test::TempFolder folder;
  {
    std::mt19937_64 random(3);
    std::ofstream text(folder / "plane.xyz");
    for (int i = 0; i < 200000; ++i) {  // turned by 30 degrees
      const double x = 1e-4 * static_cast<double>(random() % 1000000),
                   y = 1e-4 * static_cast<double>(random() % 1000000);
      text << 0.866 * x - 0.5 * y << ' ' << 0.5 * x + 0.866 * y << " 0.0\n";
    }
  }
  ConvertOptions options;
  options.inputs = {(folder / "plane.xyz").string()};
  options.output = (folder / "a.strata").string();
  options.nodePoints = 16384;
  convert(options, ConvertControl{});
  const Store store(options.output);
  const NodePoints points = readAll(store, 0);
  test::Cloud cloud;
  cloud.step = store.info().grid.scale;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::int64_t g : points.grid[axis]) cloud.axis[axis].push_back(static_cast<std::int32_t>(g));
  std::vector<std::uint32_t> order(points.count());
  std::iota(order.begin(), order.end(), 0u);
  const NodeRecord& root = store.hierarchy().nodes[0];
  const test::Evenness evenness = test::evennessOf(cloud, order, std::span(root.prefix).first(root.prefixes));
  RecordProperty("full levels", std::to_string(evenness.fullLevels));
  RecordProperty("anywhere", std::to_string(evenness.anywhere));
  EXPECT_LE(evenness.fullLevels, 0.30);
  EXPECT_LE(evenness.anywhere, 0.45);
}

class EveryColour : public testing::TestWithParam<LodColour> {};

/// 900,000 points in 512 MiB make several chunks; the tree above them is merged.
TEST_P(EveryColour, KeepsEverySourcePointExactlyOnceAndGivesTheSameBytesForAnyNumberOfThreads) {
  const test::TempFolder folder;
  ConvertOptions options;
  options.inputs = {"synthetic:city?points=900000&seed=3"};
  options.lodColour = GetParam();
  options.memoryBytes = kLeastMemoryBytes;
  for (const int threads : {1, 2}) {
    options.threads = threads;
    options.output = (folder / ("t" + std::to_string(threads))).string();
    convert(options, ConvertControl{});
  }
  EXPECT_EQ(bytesOf(folder / "t1" / kPointsFile), bytesOf(folder / "t2" / kPointsFile));
  const Store store(options.output);
  const VerifyReport report = verifyStore(store);
  EXPECT_TRUE(report.problems.empty()) << report.problems.front();
  EXPECT_EQ(store.info().sampling, "ntree");
  EXPECT_EQ(sortedPoints(store), sortedSourcePoints(options.inputs.front(), store.info()));
}

INSTANTIATE_TEST_SUITE_P(Colours, EveryColour, testing::Values(LodColour::average, LodColour::first));

TEST(Converter, AveragedColoursAreThoseOfTheSurroundingsAndOnlyOfNodesWithChildren) {
  // Black and white points of a plane in turn: what stands for many is grey, and exact colours are still there.
  const test::TempFolder folder;
  {
    std::ofstream text(folder / "grey.xyz");
    for (int i = 0; i < 60000; ++i) {
      const int c = i % 2 == 0 ? 0 : 255;
      text << std::fmod(i * 0.7548776662466927, 1.0) * 10.0 << ' ' << std::fmod(i * 0.5698402909980532, 1.0) * 10.0
           << " 0 " << c << ' ' << c << ' ' << c << '\n';
    }
  }
  ConvertOptions options;
  options.inputs = {(folder / "grey.xyz").string()};
  options.source.columns = "x,y,z,r,g,b";
  options.output = (folder / "a.strata").string();
  options.nodePoints = 1024;
  options.lodColour = LodColour::average;
  convert(options, ConvertControl{});
  const Store store(options.output);
  for (std::uint32_t n = 0; n < store.hierarchy().nodes.size(); ++n) {
    NodeData drawn;
    readForDrawing(store, n, Precision::full30, drawn);
    double sum = 0.0;
    int extremes = 0;
    for (const std::uint32_t colour : drawn.colour) {
      sum += colour & 255u;
      extremes += (colour & 255u) == 0 || (colour & 255u) == 255;
    }
    const double mean = sum / static_cast<double>(drawn.colour.size());
    if (store.hierarchy().nodes[n].childMask == 0) {
      EXPECT_EQ(extremes, static_cast<int>(drawn.colour.size())) << NodeKey{drawn.key}.text();
    } else if (drawn.key.isRoot()) {
      EXPECT_NEAR(mean, 127.5, 10.0);
      EXPECT_LT(extremes, 50);
    }
  }
  EXPECT_EQ(sortedPoints(store).size(), 60000u);
  EXPECT_TRUE(verifyStore(store).problems.empty());
}

TEST(Converter, ManyChunksGiveTheSamePointsAsOne) {
  // 6 million points in 512 MiB make several chunks; the tree above them is merged.
  const test::TempFolder folder;
  const std::string input = "synthetic:city?points=6000000&seed=3";
  convertTo(folder / "many.strata", {input}, 2, 65536);
  const Store store((folder / "many.strata").string());
  const VerifyReport report = verifyStore(store);
  EXPECT_TRUE(report.problems.empty()) << report.problems.front();
  EXPECT_EQ(report.points, 6000000u);
}

TEST(Converter, AnErrorLeavesNeitherStoreNorRemains) {
  const test::TempFolder folder;
  EXPECT_THROW(convertTo(folder / "a.strata", {(folder / "missing.las").string()}), Error);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Converter, StopsWhenAskedAndLeavesNothingUnderTheFinalName) {
  const test::TempFolder folder;
  ConvertOptions options;
  options.inputs = {"synthetic:city?points=1e8"};
  options.output = (folder / "a.strata").string();
  std::atomic<bool> stop{true};
  ConvertControl control;
  control.stop = &stop;
  EXPECT_THROW(convert(options, control), Stopped);
  EXPECT_FALSE(fs::exists(options.output));
  EXPECT_TRUE(fs::exists(options.output + ".building/journal"));
  options.inputs = {"synthetic:city?points=1e8&seed=2"};
  options.resume = true;
  EXPECT_THROW(convert(options, control), Error);  // other points than those that were begun
  EXPECT_TRUE(fs::exists(options.output + ".building/journal"));
}

TEST(Converter, TwoClustersFarApartKeepTheirCoordinates) {
  const test::TempFolder folder;
  {
    std::ofstream text(folder / "far.xyz");
    for (int i = 0; i < 500; ++i) text << "0." << 100 + i << " 1.5 2.25\n10000000." << 100 + i << " 1.5 2.25\n";
  }
  convertTo(folder / "a.strata", {(folder / "far.xyz").string()});
  const Store store((folder / "a.strata").string());
  EXPECT_TRUE(store.info().grid.exact);
  EXPECT_EQ(sortedPoints(store), sortedSourcePoints((folder / "far.xyz").string(), store.info()));
}

TEST(Converter, FilesThatWriteColoursInDifferentWaysAreAllDrawnRight) {
  const test::TempFolder folder;
  for (const int scale : {1, 256}) {
    std::ofstream ply(folder / ("colours" + std::to_string(scale) + ".ply"));
    ply << "ply\nformat ascii 1.0\nelement vertex 100\nproperty float x\nproperty float y\nproperty float z\n";
    const char* type = scale == 1 ? "uchar" : "ushort";
    for (const char* channel : {"red", "green", "blue"}) ply << "property " << type << " " << channel << "\n";
    ply << "end_header\n";
    for (int i = 0; i < 100; ++i) ply << i << " 0 0 " << 200 * scale << " " << 100 * scale << " " << 50 * scale << "\n";
  }
  convertTo(folder / "a.strata", {(folder / "colours1.ply").string(), (folder / "colours256.ply").string()});
  const Store store((folder / "a.strata").string());
  NodeData drawn;
  readForDrawing(store, 0, Precision::full30, drawn);
  ASSERT_EQ(drawn.pointCount(), 200u);
  for (const std::uint32_t colour : drawn.colour) EXPECT_EQ(colour, 200u | 100u << 8 | 50u << 16 | 255u << 24);
  EXPECT_TRUE(verifyStore(store).problems.empty());
}

/// A binary PLY of doubles: 20,000 points in 10 m and one more.
void writeDoubles(const fs::path& path, const glm::dvec3& outlier) {
  std::ofstream ply(path, std::ios::binary);
  ply << "ply\nformat binary_little_endian 1.0\nelement vertex 20001\nproperty double x\nproperty double y\n"
         "property double z\nend_header\n";
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 p(std::fmod(i * 0.7548776662466927, 1.0) * 10.0, std::fmod(i * 0.5698402909980532, 1.0) * 10.0,
                       std::fmod(i * 0.1234567890123456, 1.0));
    ply.write(reinterpret_cast<const char*>(&p), sizeof p);
  }
  ply.write(reinterpret_cast<const char*>(&outlier), sizeof outlier);
}

TEST(Converter, APointTwoThousandKilometresOffMakesNobodyElsesDoublesCoarser) {
  const test::TempFolder folder;
  for (const double far : {5.0, 2e6}) {
    const std::string name = far > 10.0 ? "far" : "near";
    writeDoubles(folder / (name + ".ply"), {far, 5.0, 0.5});
    convertTo(folder / (name + ".strata"), {(folder / (name + ".ply")).string()});
  }
  const Store near((folder / "near.strata").string()), far((folder / "far.strata").string());
  EXPECT_EQ(near.info().grid.scale, far.info().grid.scale);
}

TEST(Converter, APointBeyondEveryGridIsRefusedInsteadOfMovingTheOthers) {
  const test::TempFolder folder;
  writeDoubles(folder / "a.ply", {1e17, 0.0, 0.0});
  EXPECT_THROW(convertTo(folder / "a.strata", {(folder / "a.ply").string()}), Error);
  EXPECT_FALSE(fs::exists(folder / "a.strata"));
}

TEST(BuildFolder, DoesNotReplaceWhatAppearedUnderItsFinalName) {
  const test::TempFolder folder;
  const std::string output = (folder / "a.strata").string();
  {
    BuildFolder building(output, false, false);
    fs::create_directory(output);
    std::ofstream(output + "/scan.las") << "precious";
    EXPECT_THROW(building.publish(), Error);
  }
  EXPECT_TRUE(fs::exists(output + "/scan.las"));
  EXPECT_FALSE(fs::exists(output + ".building"));
}

TEST(Converter, AFinishedStoreWhoseNameIsTakenIsKeptForResume) {
  const test::TempFolder folder;
  const fs::path output = folder / "a.strata", building = folder / "a.strata.building", temp = folder / "temp";
  fs::create_directory(temp);
  ConvertOptions options;
  options.inputs = {"synthetic:plane?points=20000"};
  options.output = output.string();
  options.tempFolder = temp.string();
  ConvertControl control;
  control.progress = [&](const Progress& progress) {
    if (progress.stage != std::string(stage::kWrite)) return;
    fs::create_directory(output);
    std::ofstream(output / "scan.las") << "precious";
  };
  EXPECT_THROW(convert(options, control), Error);
  EXPECT_TRUE(fs::exists(output / "scan.las"));
  EXPECT_TRUE(fs::is_empty(temp));
  const std::string points = bytesOf(building / kPointsFile);
  ASSERT_FALSE(points.empty());

  options.resume = true;
  EXPECT_THROW(convert(options, ConvertControl{}), Error);  // still taken
  fs::remove_all(output);
  options.nodePoints = 2000;
  EXPECT_THROW(convert(options, ConvertControl{}), Error);  // other terms
  options.nodePoints = ConvertOptions{}.nodePoints;
  const ConvertReport report = convert(options, ConvertControl{});
  EXPECT_EQ(report.points, 20000u);
  EXPECT_EQ(bytesOf(output / kPointsFile), points);
  EXPECT_FALSE(fs::exists(building));
  EXPECT_FALSE(fs::exists(output / "journal"));
  EXPECT_EQ(verifyStore(Store(output.string())).badNodes, 0u);
}

TEST(BuildFolder, ForceReplacesAStoreButNoFolderWithAnythingElseInIt) {
  const test::TempFolder folder;
  const fs::path output = folder / "a.strata";
  convertTo(output, {"synthetic:plane?points=10"});
  EXPECT_NO_THROW(checkOutput(output.string(), true));
  EXPECT_THROW(checkOutput(output.string(), false), Error);
  std::ofstream(output / "notes.txt") << "precious";
  EXPECT_THROW(checkOutput(output.string(), true), Error);
  EXPECT_TRUE(fs::exists(output / "notes.txt"));
}

TEST(BuildFolder, DoesNotTakeOverAFolderThatNoConversionMade) {
  const test::TempFolder folder;
  fs::create_directory(folder / "a.strata.building");
  std::ofstream(folder / "a.strata.building" / "notes.txt") << "precious";
  EXPECT_THROW(BuildFolder((folder / "a.strata").string(), false, false), Error);
  EXPECT_TRUE(fs::exists(folder / "a.strata.building" / "notes.txt"));
}

}  // namespace
}  // namespace strata
