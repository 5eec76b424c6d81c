#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/program/command_line.h"
#include "core/program/exit_code.h"
#include "core/readable.h"
#include "core/version.h"
#include "io/store/plane_sizes.h"
#include "io/store/store.h"
#include "io/store/verify.h"

namespace strata {
namespace {

using Json = nlohmann::ordered_json;

Json toJson(const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}); }

Json describe(const Store& store) {
  const StoreInfo& info = store.info();
  Json attributes = Json::array();
  for (std::size_t i = 0; i < info.layout.attributes().size(); ++i) {
    const Attribute& a = info.layout.attributes()[i];
    attributes.push_back({{"name", a.name},
                          {"type", scalarName(a.type)},
                          {"components", a.components},
                          {"min", info.ranges[i].min},
                          {"max", info.ranges[i].max}});
  }
  Json sources = Json::array();
  for (const StoreSource& s : info.sources)
    sources.push_back({{"path", s.path}, {"format", s.format}, {"points", s.points}, {"skipped", s.skipped}});
  Json planes = Json::array();
  for (const PlaneSize& plane : planeSizes(store))
    planes.push_back({{"name", plane.name}, {"bytes", plane.bytes}, {"raw_bytes", plane.rawBytes}});
  return {{"points", info.points},
          {"nodes", info.nodes},
          {"bounds", {{"min", toJson(info.bounds.min)}, {"max", toJson(info.bounds.max)}}},
          {"levels", info.levels},
          {"attributes", attributes},
          {"crs", info.crs},
          {"skipped", info.skipped},
          {"scale", toJson(info.grid.scale)},
          {"exact", info.grid.exact},
          {"bytes", store.points().size()},
          {"planes", planes},
          {"sources", sources}};
}

void printText(const Store& store) {
  const StoreInfo& info = store.info();
  std::printf("%s\n", store.path().c_str());
  std::printf("  points      %s in %s nodes on %d levels, %.2f bytes a point\n", grouped(info.points).c_str(),
              grouped(info.nodes).c_str(), info.levels,
              static_cast<double>(store.points().size()) / static_cast<double>(info.points));
  std::printf("  bounds      %.3f %.3f %.3f to %.3f %.3f %.3f\n", info.bounds.min.x, info.bounds.min.y,
              info.bounds.min.z, info.bounds.max.x, info.bounds.max.y, info.bounds.max.z);
  std::printf("  grid        %g %g %g m, %s\n", info.grid.scale.x, info.grid.scale.y, info.grid.scale.z,
              info.grid.exact ? "every coordinate exact" : "coordinates within half a step");
  std::printf("  crs         %s\n", info.crs.empty() ? "not stated" : info.crs.c_str());
  for (std::size_t i = 0; i < info.layout.attributes().size(); ++i) {
    const Attribute& a = info.layout.attributes()[i];
    std::printf("  %-18s %s x %u, %g to %g\n", a.name.c_str(), std::string(scalarName(a.type)).c_str(), a.components,
                info.ranges[i].min, info.ranges[i].max);
  }
  std::printf("%s", planeSizesText(planeSizes(store), info.points).c_str());
  for (const StoreSource& s : info.sources)
    std::printf("  source      %s: %s, %s points%s\n", s.path.c_str(), s.format.c_str(), grouped(s.points).c_str(),
                s.skipped > 0 ? (", " + grouped(s.skipped) + " skipped").c_str() : "");
}

int run(int argc, char** argv) {
  CLI::App app("Says what a Strata store holds, and whether it is sound.", "strata-info");
  std::string path;
  bool json = false, verify = false;
  app.add_option("STORE", path, "NAME.strata")->required();
  app.add_flag("--json", json, "print one JSON object as the last line");
  app.add_flag("--verify", verify, "read every byte and check it");
  app.set_version_flag("--version", version());
  if (!parseCommandLine(app, argc, argv)) return 0;
  const Store store(path);
  Json description = describe(store);
  VerifyReport report;
  if (verify) {
    report = verifyStore(store);
    description["checked_nodes"] = report.checkedNodes;
    description["bad_nodes"] = report.badNodes;
  }
  if (json)
    std::printf("%s\n", description.dump(-1, ' ', false, Json::error_handler_t::replace).c_str());
  else
    printText(store);
  flushOutput();
  if (!report.problems.empty())
    throw Error(
        path, report.problems.front() +
                  (report.problems.size() > 1 ? " (and " + std::to_string(report.problems.size() - 1) + " more)" : ""));
  if (verify && !json) std::printf("  verified    %s nodes, all sound\n", grouped(report.checkedNodes).c_str());
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) { return strata::exitCodeOf(strata::run, argc, argv); }
