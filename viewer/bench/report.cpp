#include "viewer/bench/report.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "io/file/checksum.h"
#include "io/file/text_file.h"

namespace strata {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kReportSchema = 4;  // docs/flights.md, "report.json"

Json facts(const std::vector<std::pair<std::string, std::string>>& pairs) {
  Json json = Json::object();
  for (const auto& [name, value] : pairs) json[name] = value;
  return json;
}

std::string hashText(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace

std::string textHash(const std::string& text) { return hashText(checksum(std::as_bytes(std::span(text)))); }

std::string imageHash(const Image& image) {
  const std::int32_t size[2] = {image.width, image.height};
  return hashText(checksum(std::as_bytes(std::span(image.pixels)), checksum(std::as_bytes(std::span(size)))));
}

std::string storeHash(const Store& store) {
  return hashText(checksum(std::as_bytes(std::span(store.hierarchy().nodes))));
}

std::string reportJson(const BenchReport& report) {
  Json json;
  json["schema"] = kReportSchema;
  json["program"] = report.program;
  json["commit"] = report.commit;
  json["when"] = report.when;
  json["store"] = facts(report.store);
  json["store"]["path"] = report.storePath;
  json["store"]["hash"] = report.storeHash;
  json["options"] = facts(report.options);
  json["machine"] = {{"name", report.machine.name},
                     {"system", report.machine.system},
                     {"cpu", report.machine.cpu},
                     {"cores", report.machine.cores},
                     {"memory_bytes", report.machine.memory}};
  json["measures"] = Json::parse(measuresJson(report.measures));
  json["runs"] = Json::array();
  for (const BenchMeasures& run : report.runs) json["runs"].push_back(Json::parse(measuresJson(run)));
  json["noise"] = Json::object();
  for (const MeasureNoise& noise : measureNoise(report.runs)) json["noise"][noise.name] = noise.share;
  json["jumps"] = Json::array();
  for (const JumpRecord& jump : report.jumps) {
    Json reached = Json::object();
    for (std::size_t i = 0; i < std::size(JumpRecord::kShares); ++i)
      reached[std::to_string(std::lround(100.0 * JumpRecord::kShares[i]))] =
          jump.reachedMs[i] >= 0.0 ? Json(jump.reachedMs[i]) : Json();
    json["jumps"].push_back({{"t", jump.t}, {"reached_ms", reached}});
  }
  json["stages_ms"] = Json::object();
  for (const FrameStage& stage : report.stages)
    json["stages_ms"][stage.name] = {{"mean", stage.meanMs}, {"p95", stage.p95Ms}};
  json["counters"] = Json::object();
  for (const auto& [name, value] : report.counters) json["counters"][name] = value;
  json["pictures"] = Json::array();
  for (const ReportPicture& picture : report.pictures)
    json["pictures"].push_back({{"file", picture.file}, {"title", picture.title}, {"hash", picture.hash}});
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string framesCsv(const std::vector<FrameRecord>& frames) {
  std::string csv =
      "frame,t,frame_ms,list_ms,upload_ms,draw_ms,resolve_ms,settle_ms,lod_ms,points_drawn,points_listed,nodes,"
      "missing_nodes,detail,bytes_read,bytes_uploaded,queue_length,resident_bytes,gpu_bytes,pixels_covered,hitch,gpu_"
      "ms,"
      "widest_spacing_px\n";
  char line[480];
  for (const FrameRecord& f : frames) {
    std::snprintf(
        line, sizeof line,
        "%d,%.6f,%.4f,%.4f,%.4f,%.4f,%.4f,%.3f,%.4f,%llu,%llu,%u,%u,%.4f,%llu,%llu,%llu,%llu,%llu,%llu,%d,%.4f,%.3f\n",
        f.index, f.t, f.frameMs, f.listMs, f.uploadMs, f.drawMs, f.resolveMs, f.settleMs, f.lodMs,
        static_cast<unsigned long long>(f.pointsDrawn), static_cast<unsigned long long>(f.pointsListed), f.nodes,
        f.missingNodes, f.detail, static_cast<unsigned long long>(f.bytesRead),
        static_cast<unsigned long long>(f.bytesUploaded), static_cast<unsigned long long>(f.queueLength),
        static_cast<unsigned long long>(f.residentBytes), static_cast<unsigned long long>(f.gpuBytes),
        static_cast<unsigned long long>(f.pixelsCovered), f.hitch ? 1 : 0, f.gpuMs, f.widestSpacingPx);
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
