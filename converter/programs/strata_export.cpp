#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "core/error.h"
#include "core/program/command_line.h"
#include "core/program/exit_code.h"
#include "core/program/stop_signal.h"
#include "core/readable.h"
#include "core/version.h"
#include "io/open_scans.h"
#include "io/scan/scan_writer.h"
#include "io/store/node_codec.h"
#include "io/store/store.h"

namespace strata {
namespace {

/// Which points are wanted.
struct Filter {
  std::optional<Box> box;
  int deepestLevel = NodeKey::kDeepestLevel;
};

bool mayHoldWanted(const NodeRecord& record, const StoreInfo& info, const Filter& filter) {
  const NodeKey key{record.key};
  if (key.level() > filter.deepestLevel) return false;
  if (!filter.box) return true;
  const Box cube = nodeCube(key, info.rootCube());
  return glm::all(glm::lessThanEqual(cube.min, filter.box->max)) &&
         glm::all(glm::greaterThanEqual(cube.max, filter.box->min));
}

NodePoints wantedPoints(const Store& store, std::uint32_t node, const Filter& filter) {
  NodePoints all = readAll(store, node);
  if (!filter.box) return all;
  const StoreInfo& info = store.info();
  const std::size_t stride = info.layout.stride();
  NodePoints kept;
  for (std::size_t i = 0; i < all.count(); ++i) {
    const glm::dvec3 p =
        info.grid.offset + info.grid.scale * glm::dvec3(all.grid[0][i], all.grid[1][i], all.grid[2][i]);
    if (!filter.box->contains(p)) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) kept.grid[axis].push_back(all.grid[axis][i]);
    kept.attributes.insert(kept.attributes.end(), all.attributes.begin() + static_cast<std::ptrdiff_t>(i * stride),
                           all.attributes.begin() + static_cast<std::ptrdiff_t>((i + 1) * stride));
  }
  return kept;
}

/// Count and bounds of what will be written; writers need both first. Without a box the store knows.
std::uint64_t countWanted(const Store& store, const Filter& filter, Box& bounds) {
  const std::vector<NodeRecord>& nodes = store.hierarchy().nodes;
  std::uint64_t count = 0;
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    if (!mayHoldWanted(nodes[i], store.info(), filter)) continue;
    if (!filter.box) {
      count += nodes[i].pointCount;
      continue;
    }
    const NodePoints points = wantedPoints(store, i, filter);
    count += points.count();
  }
  bounds = store.info().bounds;
  if (filter.box) {
    bounds.min = glm::max(bounds.min, filter.box->min);
    bounds.max = glm::min(bounds.max, filter.box->max);
  }
  return count;
}

std::unique_ptr<ScanWriter> createWriter(const std::string& path, const StoreInfo& info, std::uint64_t points,
                                         const Box& bounds, std::optional<int> lasFormat) {
  const std::string extension = scanExtension(path);
  if (extension == ".las" || extension == ".laz")
    return createLasWriter(path, info, {points, bounds}, {extension == ".laz", lasFormat});
  return createPlyWriter(path, info, points);
}

int run(int argc, char** argv) {
  CLI::App app("Writes the points of a Strata store as LAS, LAZ or PLY.", "strata-export");
  std::string path, output;
  std::vector<double> box;
  Filter filter;
  bool force = false;
  std::optional<int> lasFormat;
  app.add_option("STORE", path, "NAME.strata")->required();
  app.add_option("-o,--output", output, "OUT.las, OUT.laz or OUT.ply")->required();
  app.add_option("--box", box, "only points in x0 y0 z0 x1 y1 z1")->expected(6);
  app.add_option("--level", filter.deepestLevel, "only nodes down to this level; 0 is the root")
      ->check(CLI::Range(0, NodeKey::kDeepestLevel));
  app.add_option("--format", lasFormat, "LAS point format; the source's own unless given")
      ->check(CLI::IsMember({0, 1, 2, 3, 6, 7, 8}));
  app.add_flag("--force", force, "replace an existing file");
  app.set_version_flag("--version", version());
  if (!parseCommandLine(app, argc, argv)) return 0;
  const std::string extension = scanExtension(output);
  if (extension != ".las" && extension != ".laz" && extension != ".ply")
    throw UsageError(output, "unknown format, found '" + extension + "' (expected .las, .laz or .ply)");
  if (lasFormat && extension == ".ply") throw UsageError("--format", "is for LAS and LAZ only");
  if (!box.empty()) {
    filter.box = Box{{box[0], box[1], box[2]}, {box[3], box[4], box[5]}};
    if (filter.box->empty()) throw UsageError("--box", "the first corner is not below the second");
  }
  if (std::filesystem::is_directory(output)) throw Error(output, "is a folder");
  if (std::filesystem::exists(output) && !force) throw Error(output, "exists already; --force replaces it");

  const Store store(path);
  Box bounds;
  const std::uint64_t count = countWanted(store, filter, bounds);
  const std::unique_ptr<ScanWriter> writer = createWriter(output, store.info(), count, bounds, lasFormat);
  const std::vector<NodeRecord>& nodes = store.hierarchy().nodes;
  listenForStop();
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    if (stopAsked()) throw Error(output, "stopped before it was complete");
    if (mayHoldWanted(nodes[i], store.info(), filter)) writer->write(wantedPoints(store, i, filter));
  }
  writer->finish();
  std::printf("%s: %s points\n", output.c_str(), grouped(count).c_str());
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) { return strata::exitCodeOf(strata::run, argc, argv); }
