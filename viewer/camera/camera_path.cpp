#include "viewer/camera/camera_path.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>

#include "core/error.h"
#include "io/file/text_file.h"

namespace strata {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kLengthSamples = 256;  // between two keys, when the speed is constant
constexpr double kMaxFps = 1000.0;
constexpr std::size_t kMaxBytes = 200'000'000;  // 200 a frame of the longest path
constexpr double kMaxFrames = 1e6;              // keeps a mistyped time from running for weeks

using Json = nlohmann::json;

glm::dvec3 tangent(const glm::dvec3& before, const glm::dvec3& here, const glm::dvec3& after, double stepBefore,
                   double stepAfter) {
  return ((after - here) / stepAfter * stepBefore + (here - before) / stepBefore * stepAfter) /
         (stepBefore + stepAfter);
}

using Run = std::span<const CameraKey>;  // keys between two cuts

/// The run that key i belongs to; `first` is the run's first key.
Run runOf(const std::vector<CameraKey>& keys, std::size_t i, std::size_t& first) {
  for (first = i; first > 0 && !keys[first].cut;) --first;
  std::size_t end = i + 1;
  while (end < keys.size() && !keys[end].cut) ++end;
  return Run(keys).subspan(first, end - first);
}

/// Tangent at key i of the curve through `member` of the keys. At an open end the curve is a parabola.
glm::dvec3 tangentAt(Run keys, std::size_t i, glm::dvec3 CameraKey::*member) {
  const std::size_t last = keys.size() - 1;
  const bool closed = keys.size() > 3 && keys[0].eye == keys[last].eye && keys[0].target == keys[last].target;
  const auto slope = [&](std::size_t k) {
    return (keys[k + 1].*member - keys[k].*member) / (keys[k + 1].t - keys[k].t);
  };
  if (i > 0 && i < last)
    return tangent(keys[i - 1].*member, keys[i].*member, keys[i + 1].*member, keys[i].t - keys[i - 1].t,
                   keys[i + 1].t - keys[i].t);
  if (closed)
    return tangent(keys[last - 1].*member, keys[0].*member, keys[1].*member, keys[last].t - keys[last - 1].t,
                   keys[1].t - keys[0].t);
  const std::size_t span = i == 0 ? 0 : last - 1;
  if (keys.size() == 2) return slope(span);
  return 2.0 * slope(span) - tangentAt(keys, i == 0 ? 1 : last - 1, member);
}

glm::dvec3 hermite(const glm::dvec3& p0, const glm::dvec3& m0, const glm::dvec3& p1, const glm::dvec3& m1, double step,
                   double u) {
  const double u2 = u * u;
  const double u3 = u2 * u;
  // Written around p0 so that equal points stay exactly equal.
  return p0 + (3.0 * u2 - 2.0 * u3) * (p1 - p0) + step * ((u3 - 2.0 * u2 + u) * m0 + (u3 - u2) * m1);
}

[[noreturn]] void refuseKey(const std::string& file, std::size_t index, const std::string& what) {
  throw Error(file, "key " + std::to_string(index + 1) + ": " + what);
}

double numberOf(const std::string& file, const Json& value, const std::string& name) {
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    throw Error(file, name + " is no number, found " + value.dump());
  return value.get<double>();
}

glm::dvec3 vectorOf(const std::string& file, const Json& key, std::size_t index, const char* name) {
  const auto found = key.find(name);
  if (found == key.end()) refuseKey(file, index, std::string(name) + " is missing");
  if (!found->is_array() || found->size() != 3)
    refuseKey(file, index, std::string(name) + ", found " + found->dump() + " (expected three numbers)");
  glm::dvec3 value;
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    const Json& number = (*found)[static_cast<std::size_t>(axis)];
    if (!number.is_number() || !std::isfinite(number.get<double>()))
      refuseKey(file, index, std::string(name) + ", found " + found->dump() + " (expected three numbers)");
    value[axis] = number.get<double>();
  }
  return value;
}

bool flagOf(const std::string& file, const Json& key, std::size_t index, const char* name) {
  const auto found = key.find(name);
  if (found == key.end()) return false;
  if (!found->is_boolean())
    refuseKey(file, index, std::string(name) + ", found " + found->dump() + " (expected true or false)");
  return found->get<bool>();
}

std::string countText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

Json parsed(const std::string& file, const std::string& text) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw Error(file, "is no JSON, at byte " + std::to_string(error.byte));
  } catch (const Json::out_of_range&) {
    throw Error(file, "holds a number too large for a double");
  }
}

CameraKey parseKey(const std::string& file, const Json& json, std::size_t index) {
  if (!json.is_object()) refuseKey(file, index, "found " + json.dump() + " (expected an object)");
  const auto t = json.find("t");
  if (t == json.end() || !t->is_number()) refuseKey(file, index, "t is missing or no number");
  CameraKey key;
  key.t = t->get<double>();
  key.eye = vectorOf(file, json, index, "eye");
  key.target = vectorOf(file, json, index, "target");
  if (json.contains("up")) key.up = vectorOf(file, json, index, "up");
  key.cut = flagOf(file, json, index, "cut");
  key.mark = flagOf(file, json, index, "mark");
  if (key.eye == key.target) refuseKey(file, index, "eye and target are the same point");
  if (glm::length(key.up) == 0.0) refuseKey(file, index, "up has no length");
  return key;
}

}  // namespace

int CameraPath::frames() const { return static_cast<int>(std::floor(duration() * fps + 1e-6)) + 1; }

View viewAt(const CameraPath& path, double t, int width, int height) {
  const std::vector<CameraKey>& keys = path.keys;
  View view;
  view.fovY = path.fovY;
  view.width = width;
  view.height = height;
  const auto after =
      std::upper_bound(keys.begin(), keys.end(), t, [](double value, const CameraKey& key) { return value < key.t; });
  if (after == keys.begin() || after == keys.end() || after->cut) {
    const CameraKey& still = after == keys.begin() ? keys.front() : after[-1];
    view.eye = still.eye;
    view.target = still.target;
    view.up = still.up;
    return view;
  }
  std::size_t first = 0;
  const Run run = runOf(keys, static_cast<std::size_t>(after - keys.begin()) - 1, first);
  const std::size_t i = static_cast<std::size_t>(after - keys.begin()) - 1 - first;
  const double step = run[i + 1].t - run[i].t;
  const double u = (t - run[i].t) / step;
  const auto curve = [&](glm::dvec3 CameraKey::*member) {
    return hermite(run[i].*member, tangentAt(run, i, member), run[i + 1].*member, tangentAt(run, i + 1, member), step,
                   u);
  };
  view.eye = curve(&CameraKey::eye);
  view.target = curve(&CameraKey::target);
  view.up = glm::mix(run[i].up, run[i + 1].up, u);
  return view;
}

PathClock::PathClock(const CameraPath& path) {
  if (path.speed == PathSpeed::keyed) return;
  const std::vector<CameraKey>& keys = path.keys;
  std::size_t first = 0;
  for (std::size_t next = 0; next < keys.size(); next = first + runOf(keys, next, first).size()) {
    const Run run = runOf(keys, next, first);
    // Length flown since the run's first key, at kLengthSamples times between each two keys.
    std::vector<double> times{run.front().t}, lengths{0.0};
    glm::dvec3 before = run.front().eye;
    for (std::size_t k = 0; k + 1 < run.size(); ++k)
      for (int s = 1; s <= kLengthSamples; ++s) {
        const bool atKey = s == kLengthSamples;
        times.push_back(atKey ? run[k + 1].t : run[k].t + (run[k + 1].t - run[k].t) * s / kLengthSamples);
        const glm::dvec3 eye = atKey ? run[k + 1].eye : viewAt(path, times.back(), 1, 1).eye;
        lengths.push_back(lengths.back() + glm::distance(before, eye));
        before = eye;
      }
    const double whole = lengths.back();
    const double begin = run.front().t;
    const double duration = run.back().t - begin;
    for (std::size_t i = 0; i < times.size(); ++i) {
      // Where the eye does not move at all the keys' own times stay.
      pathTimes_.push_back(whole > 0.0 ? begin + duration * lengths[i] / whole : times[i]);
      keyTimes_.push_back(times[i]);
    }
  }
}

double PathClock::lookUp(const std::vector<double>& from, const std::vector<double>& to, double value) {
  if (from.empty() || value <= from.front() || value >= from.back()) return value;
  const std::size_t after = static_cast<std::size_t>(std::upper_bound(from.begin(), from.end(), value) - from.begin());
  const double step = from[after] - from[after - 1];
  return step > 0.0 ? to[after - 1] + (to[after] - to[after - 1]) * (value - from[after - 1]) / step : to[after];
}

namespace {

template <class Chosen>
std::vector<int> framesOfKeys(const CameraPath& path, Chosen chosen, double (*round)(double)) {
  const PathClock clock(path);
  std::vector<int> frames;
  for (const CameraKey& key : path.keys) {
    if (!chosen(key)) continue;
    const int frame = static_cast<int>(round((clock.pathTime(key.t) - path.keys.front().t) * path.fps - 1e-6));
    frames.push_back(std::clamp(frame, 0, path.frames() - 1));
  }
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

}  // namespace

std::vector<int> markedFrames(const CameraPath& path) {
  return framesOfKeys(
      path, [](const CameraKey& key) { return key.mark; }, std::round);
}

std::vector<int> cutFrames(const CameraPath& path) {
  return framesOfKeys(
      path, [](const CameraKey& key) { return key.cut; }, std::ceil);
}

std::string cameraPathJson(const CameraPath& path) {
  const auto vector = [](const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}).dump(); };
  const double degrees = std::round(path.fovY / kDegree * 1e9) / 1e9;  // 60, not 59.99999999999999
  std::string text = "{\"fps\":" + Json(path.fps).dump() + ",\"fov_y\":" + Json(degrees).dump();
  if (path.speed == PathSpeed::constant) text += ",\"speed\":\"constant\"";
  text += ",\"keys\":[\n";
  for (const CameraKey& key : path.keys)
    text += std::string(&key == path.keys.data() ? " " : ",\n ") + "{\"t\":" + Json(key.t).dump() +
            ",\"eye\":" + vector(key.eye) + ",\"target\":" + vector(key.target) + ",\"up\":" + vector(key.up) +
            (key.cut ? ",\"cut\":true" : "") + (key.mark ? ",\"mark\":true" : "") + "}";
  return text + "\n]}\n";
}

CameraPath parseCameraPath(const std::string& file, const std::string& text) {
  const Json json = parsed(file, text);
  if (!json.is_object()) throw Error(file, "is no camera path, found JSON of type " + std::string(json.type_name()));
  CameraPath path;
  if (json.contains("fps")) path.fps = numberOf(file, json["fps"], "fps");
  if (!(path.fps > 0.0 && path.fps <= kMaxFps))
    throw Error(file, "fps, found " + Json(path.fps).dump() + " (expected above 0, at most 1000)");
  if (json.contains("fov_y")) path.fovY = numberOf(file, json["fov_y"], "fov_y") * kDegree;
  if (!(path.fovY >= 1.0 * kDegree && path.fovY <= 170.0 * kDegree))
    throw Error(file, "fov_y, found " + json["fov_y"].dump() + " (expected 1 to 170 degrees)");
  if (const auto speed = json.find("speed"); speed != json.end()) {
    if (*speed != "keyed" && *speed != "constant")
      throw Error(file, "speed, found " + speed->dump() + " (expected \"keyed\" or \"constant\")");
    path.speed = *speed == "constant" ? PathSpeed::constant : PathSpeed::keyed;
  }
  const auto keys = json.find("keys");
  if (keys == json.end() || !keys->is_array() || keys->empty())
    throw Error(file, "keys is missing or empty (expected a list of at least one key)");
  for (std::size_t i = 0; i < keys->size(); ++i) {
    path.keys.push_back(parseKey(file, (*keys)[i], i));
    if (i > 0 && !(path.keys[i].t > path.keys[i - 1].t))
      refuseKey(file, i, "t " + Json(path.keys[i].t).dump() + " is not after " + Json(path.keys[i - 1].t).dump());
  }
  if (!(path.duration() * path.fps < kMaxFrames))
    throw Error(file, "too long, found " + countText(path.duration() * path.fps) + " frames (expected under 1e6)");
  return path;
}

CameraPath readCameraPath(const std::string& file) { return parseCameraPath(file, readText(file, kMaxBytes)); }

}  // namespace strata
