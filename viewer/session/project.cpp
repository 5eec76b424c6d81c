#include "viewer/session/project.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/error.h"
#include "viewer/session/colour_names.h"
#include "viewer/session/draw_flags.h"

namespace strata {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr double kDegree = std::numbers::pi / 180.0;

Json vectorJson(const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}); }

Json viewJson(const View& view) {
  return {{"eye", vectorJson(view.eye)},       {"target", vectorJson(view.target)},
          {"up", vectorJson(view.up)},         {"fov_y", view.fovY / kDegree},
          {"orthographic", view.orthographic}, {"orthographic_height", view.orthographicHeight}};
}

/// Reads members of an object; every fault names the file and the member.
class Members {
 public:
  Members(const std::string& file, const Json& object, std::string where)
      : file_(file), object_(object), where_(std::move(where)) {
    if (!object_.is_object()) fail("", "an object");
  }

  const Json* find(const char* name) const {
    const auto found = object_.find(name);
    return found == object_.end() ? nullptr : &*found;
  }
  void read(const char* name, double& out) const {
    if (const Json* value = find(name)) {
      if (!value->is_number()) fail(name, "a number");
      out = value->get<double>();
    }
  }
  void read(const char* name, bool& out) const {
    if (const Json* value = find(name)) {
      if (!value->is_boolean()) fail(name, "true or false");
      out = value->get<bool>();
    }
  }
  void read(const char* name, std::string& out) const {
    if (const Json* value = find(name)) {
      if (!value->is_string()) fail(name, "a text");
      out = value->get<std::string>();
    }
  }
  void read(const char* name, int& out, int least, int most) const {
    double value = out;
    read(name, value);
    if (!(value >= least && value <= most)) fail(name, std::to_string(least) + " to " + std::to_string(most));
    out = static_cast<int>(value);
  }
  void read(const char* name, glm::dvec3& out) const {
    if (const Json* value = find(name)) out = vector(name, *value);
  }
  glm::dvec3 vector(const char* name, const Json& value) const {
    if (!value.is_array() || value.size() != 3 || !value[0].is_number() || !value[1].is_number() ||
        !value[2].is_number())
      fail(name, "three numbers");
    return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
  }
  std::vector<Json> list(const char* name) const {
    const Json* value = find(name);
    if (value == nullptr) return {};
    if (!value->is_array()) fail(name, "a list");
    return {value->begin(), value->end()};
  }
  [[noreturn]] void fail(const std::string& name, const std::string& expected) const {
    throw Error(file_,
                where_ + (name.empty() || where_.empty() ? "" : ".") + name + " is wrong (expected " + expected + ")");
  }

 private:
  const std::string& file_;
  const Json& object_;
  const std::string where_;
};

View parseView(const std::string& file, const Json& json, const std::string& where) {
  const Members members(file, json, where);
  View view;
  double degrees = view.fovY / kDegree;
  members.read("eye", view.eye);
  members.read("target", view.target);
  members.read("up", view.up);
  members.read("fov_y", degrees);
  members.read("orthographic", view.orthographic);
  members.read("orthographic_height", view.orthographicHeight);
  if (!(degrees >= 1.0 && degrees <= 170.0)) members.fail("fov_y", "1 to 170 degrees");
  if (!(view.orthographicHeight > 0.0)) members.fail("orthographic_height", "more than 0");
  if (view.eye == view.target) members.fail("target", "another point than the eye");
  view.fovY = degrees * kDegree;
  return view;
}

Measurement parseMeasurement(const std::string& file, const Json& json, const std::string& where) {
  const Members members(file, json, where);
  Measurement m;
  std::string kind = measureName(m.kind);
  members.read("name", m.name);
  members.read("kind", kind);
  members.read("visible", m.visible);
  try {
    m.kind = parseMeasure(kind);
  } catch (const UsageError&) {
    members.fail("kind", "point, distance, height, angle, area, polyline or profile");
  }
  for (const Json& point : members.list("points")) m.points.push_back(members.vector("points", point));
  if (m.kind == MeasureKind::distance && m.points.size() > 2) m.kind = MeasureKind::polyline;  // its name once
  members.read("width", m.width);
  if (!(m.width > 0.0)) members.fail("width", "more than 0 metres");
  if (m.points.size() < leastPoints(m.kind) || m.points.size() > mostPoints(m.kind))
    members.fail("points", "as many as the kind needs");
  return m;
}

ClipBox parseClipBox(const std::string& file, const Json& json) {
  const Members members(file, json, "clip_boxes");
  ClipBox box;
  std::string show = "inside";
  members.read("name", box.name);
  members.read("on", box.on);
  members.read("show", show);
  if (show != "inside" && show != "outside") members.fail("show", "inside or outside");
  box.cutout = show == "outside";
  glm::dvec3 from(1.0), to(-1.0);
  members.read("from", from);
  members.read("to", to);
  box.box = {from, to};
  if (box.box.empty()) members.fail("to", "from and to, two corners of a box");
  return box;
}

Json classesJson(const std::bitset<256>& classes) {
  Json list = Json::array();
  for (std::size_t c = 0; c < classes.size(); ++c)
    if (classes[c]) list.push_back(c);
  return list;
}

std::string colourText(const glm::u8vec3& colour) {
  char text[8];
  std::snprintf(text, sizeof text, "%02x%02x%02x", colour.x, colour.y, colour.z);
  return text;
}

void parseBackground(const Members& members, DrawOptions& draw) {
  std::string top = colourText(draw.background), below;
  members.read("background", top);
  members.read("background_below", below);
  try {
    draw.background = parseHexColour(top);
    if (!below.empty()) draw.backgroundBelow = parseHexColour(below);
  } catch (const UsageError&) {
    members.fail("background", "RRGGBB");
  }
}

void parseDraw(const Members& members, Project& project) {
  DrawOptions& draw = project.draw;
  std::string colour = colourName(draw.colour);
  members.read("colour", colour);
  try {
    draw.colour = parseColour(colour).value_or(draw.colour);
  } catch (const UsageError&) {
    members.fail("colour", "the name of a colour mode");
  }
  double strength = draw.edlStrength, low = draw.intensityRange.x, high = draw.intensityRange.y;
  bool highQuality = draw.shading == Shading::highQuality;
  members.read("point_size", draw.pointSize, 1, DrawOptions::kLargestPoint);
  members.read("edl", draw.edl);
  members.read("edl_strength", strength);
  members.read("high_quality", highQuality);
  members.read("intensity_low", low);
  members.read("intensity_high", high);
  members.read("elevation_low", draw.elevationRange.x);
  members.read("elevation_high", draw.elevationRange.y);
  members.read("fill", draw.fill, 1, DrawOptions::kLargestFill);
  if (draw.fill % 2 == 0) members.fail("fill", "1, 3, 5 or 7");
  members.read("jump_flood", draw.jumpFlood);
  for (const Json& hidden : members.list("hidden_classes")) {
    if (!hidden.is_number_unsigned() || hidden.get<std::uint64_t>() > 255)
      members.fail("hidden_classes", "classes from 0 to 255");
    draw.classes.reset(hidden.get<std::size_t>());
  }
  parseBackground(members, draw);
  draw.edlStrength = static_cast<float>(strength);
  draw.shading = highQuality ? Shading::highQuality : Shading::plain;
  draw.intensityRange = {static_cast<float>(low), static_cast<float>(high)};
  double budget = static_cast<double>(project.pointBudget);
  members.read("point_budget", budget);
  members.read("points_per_pixel", project.pointsPerPixel);
  if (!(budget >= 1.0 && budget <= static_cast<double>(SelectionOptions::kMaxPointBudget)))
    members.fail("point_budget", "1 or more points");
  if (!(project.pointsPerPixel > 0.0)) members.fail("points_per_pixel", "more than 0");
  project.pointBudget = static_cast<std::uint64_t>(budget);
}

}  // namespace

std::string projectJson(const std::string& path, const Project& project) {
  Json json;
  json["strata_project"] = kVersion;
  const fs::path folder = fs::absolute(path).parent_path();
  json["stores"] = Json::array();
  for (std::size_t i = 0; i < project.stores.size(); ++i) {
    const fs::path relative = fs::absolute(project.stores[i]).lexically_normal().lexically_relative(folder);
    const bool shown = i >= project.shown.size() || project.shown[i];
    json["stores"].push_back({{"path", relative.empty() ? project.stores[i] : relative.string()}, {"shown", shown}});
  }
  json["camera"] = viewJson(project.view);
  const DrawOptions& draw = project.draw;
  json["settings"] = {{"colour", colourName(draw.colour)},
                      {"point_size", draw.pointSize},
                      {"edl", draw.edl},
                      {"edl_strength", draw.edlStrength},
                      {"high_quality", draw.shading == Shading::highQuality},
                      {"intensity_low", draw.intensityRange.x},
                      {"intensity_high", draw.intensityRange.y},
                      {"elevation_low", draw.elevationRange.x},
                      {"elevation_high", draw.elevationRange.y},
                      {"fill", draw.fill},
                      {"jump_flood", draw.jumpFlood},
                      {"background", colourText(draw.background)},
                      {"hidden_classes", classesJson(~draw.classes)},
                      {"point_budget", project.pointBudget},
                      {"points_per_pixel", project.pointsPerPixel}};
  if (draw.backgroundBelow) json["settings"]["background_below"] = colourText(*draw.backgroundBelow);
  json["clip_boxes"] = Json::array();
  for (const ClipBox& box : project.clipBoxes)
    json["clip_boxes"].push_back({{"name", box.name},
                                  {"on", box.on},
                                  {"show", box.cutout ? "outside" : "inside"},
                                  {"from", vectorJson(box.box.min)},
                                  {"to", vectorJson(box.box.max)}});
  json["bookmarks"] = Json::array();
  for (const Bookmark& bookmark : project.bookmarks)
    json["bookmarks"].push_back({{"name", bookmark.name}, {"camera", viewJson(bookmark.view)}});
  json["measurements"] = Json::array();
  for (const Measurement& m : project.measurements) {
    Json points = Json::array();
    for (const glm::dvec3& point : m.points) points.push_back(vectorJson(point));
    json["measurements"].push_back(
        {{"name", m.name}, {"kind", measureName(m.kind)}, {"visible", m.visible}, {"points", points}});
    if (m.kind == MeasureKind::profile) json["measurements"].back()["width"] = m.width;
  }
  if (project.path) json["path"] = Json::parse(cameraPathJson(*project.path));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Project parseProject(const std::string& path, const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw Error(path, "is no JSON");
  if (!json.is_object() || !json.contains("strata_project")) throw Error(path, "is no project of strata-view");
  if (json["strata_project"] != kVersion)
    throw Error(path, "project version, found " + json["strata_project"].dump() + " (expected 1)");
  const Members members(path, json, "");
  Project project;
  const fs::path folder = fs::absolute(path).parent_path();
  for (const Json& entry : members.list("stores")) {
    const Members store(path, entry, "stores");
    std::string name;
    bool shown = true;
    store.read("path", name);
    store.read("shown", shown);
    if (name.empty()) store.fail("path", "the path of a store");
    project.stores.push_back((folder / name).lexically_normal().string());
    project.shown.push_back(shown);
  }
  if (project.stores.empty()) members.fail("stores", "at least one store");
  if (const Json* camera = members.find("camera")) project.view = parseView(path, *camera, "camera");
  if (const Json* settings = members.find("settings")) parseDraw(Members(path, *settings, "settings"), project);
  for (const Json& entry : members.list("bookmarks")) {
    const Members bookmark(path, entry, "bookmarks");
    Bookmark read;
    bookmark.read("name", read.name);
    if (const Json* camera = bookmark.find("camera")) read.view = parseView(path, *camera, "bookmarks.camera");
    project.bookmarks.push_back(std::move(read));
  }
  for (const Json& entry : members.list("clip_boxes")) project.clipBoxes.push_back(parseClipBox(path, entry));
  for (const Json& entry : members.list("measurements"))
    project.measurements.push_back(parseMeasurement(path, entry, "measurements"));
  if (const Json* flight = members.find("path")) project.path = parseCameraPath(path, flight->dump());
  return project;
}

}  // namespace strata
