#include "viewer/report.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "viewer/text_file.h"

namespace strata {
namespace {

using Json = nlohmann::ordered_json;

Json facts(const std::vector<std::pair<std::string, std::string>>& pairs) {
  Json json = Json::object();
  for (const auto& [name, value] : pairs) json[name] = value;
  return json;
}

}  // namespace

std::string reportJson(const BenchReport& report) {
  Json json;
  json["program"] = report.program;
  json["when"] = report.when;
  json["store"] = facts(report.store);
  json["store"]["path"] = report.storePath;
  json["options"] = facts(report.options);
  json["machine"] = {{"name", report.machine.name},
                     {"system", report.machine.system},
                     {"cpu", report.machine.cpu},
                     {"cores", report.machine.cores},
                     {"memory_bytes", report.machine.memory}};
  json["measures"] = Json::parse(measuresJson(report.measures));
  json["stages_ms"] = Json::object();
  for (const StageTime& stage : report.stages)
    json["stages_ms"][stage.name] = {{"mean", stage.meanMs}, {"p95", stage.p95Ms}};
  json["counters"] = Json::object();
  for (const auto& [name, value] : report.counters) json["counters"][name] = value;
  json["pictures"] = Json::array();
  for (const ReportPicture& picture : report.pictures) json["pictures"].push_back(picture.file);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string framesCsv(const std::vector<FrameRecord>& frames) {
  std::string csv =
      "frame,t,frame_ms,list_ms,upload_ms,draw_ms,resolve_ms,settle_ms,lod_ms,points_drawn,points_listed,nodes,"
      "missing_nodes,bytes_read,bytes_uploaded,hitch\n";
  char line[320];
  for (const FrameRecord& f : frames) {
    std::snprintf(line, sizeof line, "%d,%.6f,%.4f,%.4f,%.4f,%.4f,%.4f,%.3f,%.4f,%llu,%llu,%u,%u,%llu,%llu,%d\n",
                  f.index, f.t, f.frameMs, f.listMs, f.uploadMs, f.drawMs, f.resolveMs, f.settleMs, f.lodMs,
                  static_cast<unsigned long long>(f.pointsDrawn), static_cast<unsigned long long>(f.pointsListed),
                  f.nodes, f.missingNodes, static_cast<unsigned long long>(f.bytesRead),
                  static_cast<unsigned long long>(f.bytesUploaded), f.hitch ? 1 : 0);
    csv += line;
  }
  return csv;
}

void writeReport(const std::string& folder, const BenchReport& report) {
  writeText(folder + "/report.json", reportJson(report));
  writeText(folder + "/frames.csv", framesCsv(report.frames));
  writeText(folder + "/report.html", reportHtml(report));
}

}  // namespace strata
