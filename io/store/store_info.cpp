#include "io/store/store_info.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace strata {
namespace {

using Json = nlohmann::ordered_json;

Json toJson(const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}); }
glm::dvec3 toVector(const Json& j) { return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()}; }

Json toJson(const LasMeta& las) {
  Json vlrs = Json::array();
  for (const LasMeta::Vlr& v : las.vlrs)
    vlrs.push_back(
        {{"user_id", v.userId}, {"record_id", v.recordId}, {"description", v.description}, {"data", v.data}});
  return {{"version_minor", las.versionMinor},
          {"point_format", las.pointFormat},
          {"record_bytes", las.recordBytes},
          {"scale", toJson(las.scale)},
          {"offset", toJson(las.offset)},
          {"global_encoding", las.globalEncoding},
          {"file_source_id", las.fileSourceId},
          {"creation_day", las.creationDay},
          {"creation_year", las.creationYear},
          {"system_identifier", las.systemIdentifier},
          {"generating_software", las.generatingSoftware},
          {"vlrs", vlrs}};
}

LasMeta toLasMeta(const Json& j) {
  LasMeta las;
  las.versionMinor = j.at("version_minor");
  las.pointFormat = j.at("point_format");
  las.recordBytes = j.at("record_bytes");
  las.scale = toVector(j.at("scale"));
  las.offset = toVector(j.at("offset"));
  las.globalEncoding = j.at("global_encoding");
  las.fileSourceId = j.at("file_source_id");
  las.creationDay = j.at("creation_day");
  las.creationYear = j.at("creation_year");
  las.systemIdentifier = j.at("system_identifier");
  las.generatingSoftware = j.at("generating_software");
  for (const Json& v : j.at("vlrs"))
    las.vlrs.push_back(
        {v.at("user_id"), v.at("record_id"), v.at("description"), v.at("data").get<std::vector<std::uint8_t>>()});
  return las;
}

Json attributesJson(const StoreInfo& info) {
  Json attributes = Json::array();
  for (std::size_t i = 0; i < info.layout.attributes().size(); ++i) {
    const Attribute& a = info.layout.attributes()[i];
    const AttributeRange range = i < info.ranges.size() ? info.ranges[i] : AttributeRange{};
    attributes.push_back({{"name", a.name},
                          {"type", scalarName(a.type)},
                          {"components", a.components},
                          {"description", a.description},
                          {"scale", a.scale},
                          {"offset", a.offset},
                          {"min", range.min},
                          {"max", range.max},
                          {"low", range.low},
                          {"high", range.high}});
  }
  return attributes;
}

/// Reads a double of a range, which is null in the file when the source held NaN or infinity.
double number(const Json& j) { return j.is_number() ? j.get<double>() : 0.0; }

void readAttributes(const Json& j, StoreInfo& info) {
  std::vector<Attribute> attributes;
  for (const Json& a : j) {
    attributes.push_back({a.at("name"), parseScalarType(a.at("type").get<std::string>()), a.at("components"),
                          a.at("description"), number(a.at("scale")), number(a.at("offset"))});
    if (attributes.back().components == 0) throw Error("attribute '" + attributes.back().name + "' has no components");
    info.ranges.push_back({number(a.at("min")), number(a.at("max")), number(a.at("low")), number(a.at("high"))});
  }
  info.layout = PointLayout(std::move(attributes));
}

StoreInfo fromJson(const Json& j) {
  StoreInfo info;
  info.program = j.at("program");
  info.points = j.at("points");
  info.nodes = j.at("nodes");
  info.levels = j.at("levels");
  info.bounds = {toVector(j.at("bounds").at("min")), toVector(j.at("bounds").at("max"))};
  info.grid.scale = toVector(j.at("grid").at("scale"));
  info.grid.offset = toVector(j.at("grid").at("offset"));
  info.grid.exact = j.at("grid").at("exact");
  info.cubeBits = j.at("grid").at("cube_bits");
  info.crs = j.at("crs");
  readAttributes(j.at("attributes"), info);
  info.colourShift = j.at("colour_shift");
  info.nodePoints = j.at("conversion").at("node_points");
  info.sampling = j.at("conversion").at("sampling");
  info.skipped = j.at("skipped");
  for (const Json& s : j.at("sources"))
    info.sources.push_back({s.at("path"), s.at("format"), s.at("points"), s.at("skipped")});
  if (j.contains("las")) info.las = toLasMeta(j.at("las"));
  if (info.cubeBits < 0 || info.cubeBits > 52 || info.colourShift < 0 || info.colourShift > 8)
    throw Error("cube_bits or colour_shift out of range");
  return info;
}

}  // namespace

Box StoreInfo::rootCube() const {
  const double steps = std::ldexp(1.0, cubeBits);
  return {grid.offset, grid.offset + grid.scale * steps};
}

std::string storeInfoJson(const StoreInfo& info) {
  Json sources = Json::array();
  for (const StoreSource& s : info.sources)
    sources.push_back({{"path", s.path}, {"format", s.format}, {"points", s.points}, {"skipped", s.skipped}});
  Json j{{"format", "strata store"},
         {"version", info.version},
         {"program", info.program},
         {"points", info.points},
         {"skipped", info.skipped},
         {"nodes", info.nodes},
         {"levels", info.levels},
         {"bounds", {{"min", toJson(info.bounds.min)}, {"max", toJson(info.bounds.max)}}},
         {"grid",
          {{"scale", toJson(info.grid.scale)},
           {"offset", toJson(info.grid.offset)},
           {"exact", info.grid.exact},
           {"largest_error", toJson(info.grid.exact ? glm::dvec3(0.0) : info.grid.scale * 0.5)},
           {"cube_bits", info.cubeBits}}},
         {"crs", info.crs},
         {"attributes", attributesJson(info)},
         {"colour_shift", info.colourShift},
         {"conversion", {{"node_points", info.nodePoints}, {"sampling", info.sampling}}},
         {"sources", sources}};
  if (info.las) j["las"] = toJson(*info.las);
  return j.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

StoreInfo parseStoreInfo(const std::string& path, const std::string& json) {
  const Json j = Json::parse(json, nullptr, false);
  if (j.is_discarded() || !j.is_object()) throw Error(path, "is not JSON");
  try {
    if (j.value("format", "") != "strata store") throw Error("is not a Strata store");
    const int version = j.at("version");
    if (version != kStoreVersion)
      throw Error("store version is not supported, found " + std::to_string(version) + " (expected " +
                  std::to_string(kStoreVersion) + ")");
    return fromJson(j);
  } catch (const std::exception& problem) {
    throw Error(path, problem.what());
  }
}

}  // namespace strata
