// Measures on one core, stage by stage, what it takes to turn the bytes of nodes into what is drawn. Every stage uses
// the same nodes, with a few million points of a store.
//
// decode_bench STORE [Google Benchmark's options]
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <functional>
#include <memory>

#include "core/error.h"
#include "io/file/checksum.h"
#include "io/store/attribute_codec.h"
#include "io/store/bit_packing.h"
#include "io/store/colour_codec.h"
#include "io/store/column_codec.h"
#include "io/store/drawing_order.h"
#include "io/store/node_codec.h"
#include "io/store/payload_head.h"
#include "io/store/position_codec.h"
#include "lod/occluders.h"

namespace strata {
namespace {

constexpr std::uint64_t kPoints = 3'000'000;  ///< points of the nodes in the sample

struct Plane {
  PlaneEncoding encoding{};
  std::vector<std::byte> stored;  ///< with kBitSlack bytes behind it
  std::span<const std::byte> bytes() const { return std::span(stored).first(stored.size() - kBitSlack); }
};

struct Node {
  std::uint32_t index = 0;
  NodeRecord record;
  std::vector<std::byte> payload;
  ParsedHead head;
  NodeData drawn;

  const PayloadPlane* find(int id) const {
    for (const PayloadPlane& p : head.planes)
      if (p.id == id) return &p;
    return nullptr;
  }
  Plane plane(int id) const {
    std::size_t at = record.headBytes;
    for (const PayloadPlane& p : head.planes) {
      if (p.id == id) {
        Plane plane{static_cast<PlaneEncoding>(p.encoding), {}};
        plane.stored.assign(payload.begin() + static_cast<std::ptrdiff_t>(at),
                            payload.begin() + static_cast<std::ptrdiff_t>(at + p.storedBytes));
        plane.stored.resize(p.storedBytes + kBitSlack);
        return plane;
      }
      at += p.storedBytes;
    }
    return {};
  }
};

struct Sample {
  std::unique_ptr<Store> store;
  std::vector<Node> nodes;
  std::uint64_t points = 0;
};

/// Takes nodes from all over the hierarchy.
Sample takeSample(const std::string& path) {
  Sample sample{std::make_unique<Store>(path), {}, 0};
  const Store& store = *sample.store;
  const auto count = static_cast<std::uint32_t>(store.hierarchy().nodes.size());
  const auto step = static_cast<std::uint32_t>(std::max<std::uint64_t>(1, store.info().points / kPoints));
  for (std::uint32_t i = 0; i < count && sample.points < kPoints; i += step) {
    Node node;
    node.index = i;
    node.record = store.hierarchy().nodes[i];
    node.payload.resize(node.record.payloadBytes);
    store.points().read(node.record.offset, node.payload);
    node.head = parseHead(node.record, node.payload);
    readForDrawing(store, i, Precision::full30, node.drawn);
    sample.points += node.record.pointCount;
    sample.nodes.push_back(std::move(node));
  }
  return sample;
}

/// Measures a stage. `stage` handles one node and returns the number of stored bytes that it took.
void overNodes(benchmark::State& state, const Sample& sample, const std::function<std::uint64_t(std::size_t)>& stage) {
  std::uint64_t bytes = 0;
  for (auto _ : state)
    for (std::size_t n = 0; n < sample.nodes.size(); ++n) bytes += stage(n);
  const double points = static_cast<double>(sample.points) * static_cast<double>(state.iterations());
  state.counters["ns/point"] =
      benchmark::Counter(1e-9 * points, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["MB/s"] = benchmark::Counter(1e-6 * static_cast<double>(bytes), benchmark::Counter::kIsRate);
  state.counters["bytes/point"] = static_cast<double>(bytes) / points;
}

void must(bool decoded) {
  if (!decoded) throw Error("decode_bench", "a plane does not decode");
}

/// Measures a stage of one plane, which is found before the clock runs.
void addPlane(const Sample& sample, const std::string& name, int id,
              const std::function<void(const Node&, const Plane&)>& stage) {
  auto planes = std::make_shared<std::vector<Plane>>();
  std::uint64_t bytes = 0;
  for (const Node& node : sample.nodes) {
    planes->push_back(node.find(id) != nullptr ? node.plane(id) : Plane{});
    bytes += planes->back().stored.size();
  }
  if (bytes == 0) return;
  benchmark::RegisterBenchmark(name.c_str(), [&sample, planes, stage](benchmark::State& state) {
    overNodes(state, sample, [&](std::size_t n) -> std::uint64_t {
      const Plane& plane = (*planes)[n];
      if (plane.stored.empty()) return 0;
      stage(sample.nodes[n], plane);
      return plane.bytes().size();
    });
  })->Unit(benchmark::kMillisecond);
}

template <class T>
void addComponent(const Sample& sample, const std::string& name) {
  const int index = sample.store->info().layout.find(name);
  if (index < 0) return;
  auto spare = std::make_shared<std::vector<std::uint8_t>>();
  auto out = std::make_shared<std::vector<T>>();
  addPlane(sample, name, kFirstAttributePlane + index, [=](const Node& node, const Plane& plane) {
    if (plane.encoding != kColumns) return;
    std::span<const std::byte> rest = plane.bytes();
    out->resize(node.record.pointCount);
    ComponentDecoder<T> decoder;
    must(decoder.open(rest, out->size(), *spare));
    toDrawingOrder(node.head.levelEnds, std::span(*out), [&](std::size_t, std::span<T> v) { decoder.read(v); });
  });
}

void addStages(const Sample& sample) {
  const auto add = [&sample](const char* name, std::function<std::uint64_t(const Node&)> stage) {
    benchmark::RegisterBenchmark(name, [&sample, stage](benchmark::State& state) {
      overNodes(state, sample, [&](std::size_t n) { return stage(sample.nodes[n]); });
    })->Unit(benchmark::kMillisecond);
  };
  const StoreInfo& info = sample.store->info();
  auto bytes = std::make_shared<std::vector<std::byte>>();
  add("copy out of the page cache", [bytes, &sample](const Node& node) {
    bytes->resize(node.record.drawBytes[2]);
    sample.store->points().read(node.record.offset, *bytes);
    return bytes->size();
  });
  add("checksum", [](const Node& node) {
    benchmark::DoNotOptimize(checksum(std::span(node.payload).first(node.record.drawBytes[2])));
    return node.record.drawBytes[2];
  });
  auto lanes = std::make_shared<std::vector<Lanes>>();
  addPlane(sample, "position 10, its columns", kPosition10, [](const Node& node, const Plane& plane) {
    std::span<const std::byte> rest = plane.bytes().subspan(node.head.levelEnds.size());
    std::uint32_t cells = 0;
    std::memcpy(&cells, rest.data(), sizeof cells);
    rest = rest.subspan(sizeof cells);
    static std::vector<std::uint8_t> occupancy, flags;
    occupancy.resize(cells);
    flags.resize((node.record.pointCount + 7) / 8);
    must(takeColumn(rest, occupancy) && takeColumn(rest, flags));
  });
  auto octree = std::make_shared<OctreeDecoder>();
  addPlane(sample, "position 10", kPosition10, [lanes, octree](const Node& node, const Plane& plane) {
    lanes->resize(node.record.pointCount);
    must(octree->open(node.head.head, node.head.levelEnds, plane.bytes()));
    toDrawingOrder(node.head.levelEnds, std::span(*lanes),
                   [&](std::size_t first, std::span<Lanes> out) { must(octree->read(first, out)); });
  });
  for (const int p : {1, 2})
    addPlane(sample, p == 1 ? "position 20" : "position 30", kPosition10 + p,
             [lanes, p](const Node& node, const Plane& plane) {
               if (plane.bytes().empty()) return;
               lanes->resize(node.record.pointCount);
               const LaneFields fields = planeFields(node.head.head, p);
               toDrawingOrder(node.head.levelEnds, std::span(*lanes), [&](std::size_t first, std::span<Lanes> out) {
                 fields.read(plane.bytes().data(), first, out);
               });
             });
  auto spare = std::make_shared<std::vector<std::uint8_t>>();
  addPlane(sample, "colour, its columns", kColour, [spare](const Node& node, const Plane& plane) {
    std::span<const std::byte> rest = plane.bytes();
    spare->resize(node.record.pointCount);
    for (int c = 0; c < 3; ++c) must(takeColumn(rest, *spare));
  });
  addPlane(sample, "colour", kColour, [spare, lanes](const Node& node, const Plane& plane) {
    lanes->resize(node.record.pointCount);
    ColourDecoder decoder;
    must(decoder.open(plane.bytes(), lanes->size(), *spare));
    toDrawingOrder(node.head.levelEnds, std::span(*lanes),
                   [&](std::size_t, std::span<std::uint32_t> out) { decoder.read(out); });
  });
  addComponent<std::uint16_t>(sample, std::string(attribute::kIntensity));
  addComponent<std::uint8_t>(sample, std::string(attribute::kClassification));
  auto drawn = std::make_shared<NodeData>();
  auto scratch = std::make_shared<DecodeScratch>();
  for (const Precision precision : {Precision::low10, Precision::medium20, Precision::full30}) {
    const std::string name = "all for drawing, " + std::to_string(10 * static_cast<int>(precision)) + " bits";
    add(name.c_str(), [&info, drawn, scratch, precision](const Node& node) {
      const std::span<const std::byte> leading = std::span(node.payload).first(drawBytes(node.record, precision));
      decodeForDrawing(node.record, info, {leading, 0, leading}, *scratch, *drawn);
      return leading.size();
    });
  }
  auto occluders = std::make_shared<OccluderSet>();
  add("finding occluders", [&info, occluders](const Node& node) {
    findOccluders(node.drawn, nodeCube(NodeKey{node.record.key}, info.rootCube()), node.record.childMask, *occluders);
    return node.record.drawBytes[2];
  });
  auto encodeScratch = std::make_shared<EncodeScratch>();
  auto all = std::make_shared<std::vector<NodePoints>>();
  for (const Node& node : sample.nodes) all->push_back(decodeAll(node.record, info, node.payload));
  benchmark::RegisterBenchmark("encoding all planes", [&sample, &info, all, encodeScratch](benchmark::State& state) {
    overNodes(state, sample, [&](std::size_t n) { return encodeNode((*all)[n], info, *encodeScratch).payload.size(); });
  })->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (argc != 2) {
    std::fprintf(stderr, "error: see the head of tests/bench/decode_bench.cpp\n");
    return 2;
  }
  try {
    const strata::Sample sample = strata::takeSample(argv[1]);
    strata::addStages(sample);
    benchmark::RunSpecifiedBenchmarks();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
