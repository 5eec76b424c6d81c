#include "viewer/bench/compare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/file/text_file.h"
#include "viewer/bench/measures.h"
#include "viewer/output/html_text.h"

namespace strata {
namespace {

using Json = nlohmann::json;

using Better = MeasureField::Better;

Json parseReport(const std::string& file, const std::string& text) {
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw Error(file, "is no JSON");
  if (!json.is_object() || !json.contains("measures") || !json["measures"].is_object())
    throw Error(file, "is no report of strata-bench (expected an object with measures)");
  return json;
}

bool has(const Json& report, const MeasureField& measure) {
  return report["measures"].contains(Json::json_pointer(measure.pointer));
}

double numberAt(const std::string& file, const Json& report, const MeasureField& measure) {
  const Json& measures = report["measures"];
  const Json::json_pointer where(measure.pointer);
  if (!measures.contains(where) || !measures[where].is_number())
    throw Error(file, std::string("measure ") + measure.name + " is missing or no number");
  return measures[where].get<double>();
}

MeasureChange change(const MeasureField& measure, double a, double b) {
  MeasureChange result{measure.name, a, b, 1.0, 0.0, -1.0};
  if (a != b) result.ratio = a != 0.0 ? b / a : std::numeric_limits<double>::infinity();
  if (measure.better == Better::lower) result.worseBy = result.ratio - 1.0;
  if (measure.better == Better::higher) result.worseBy = b != 0.0 ? a / b - 1.0 : (a > 0.0 ? INFINITY : 0.0);
  return result;
}

std::string textOf(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

/// How far a measure strays in the run with the greater unrest; -1 where neither was repeated.
double noiseOf(const Json& a, const Json& b, const std::string& name) {
  double noise = -1.0;
  for (const Json* report : {&a, &b})
    if (report->contains("noise") && (*report)["noise"].is_object())
      if (const auto found = (*report)["noise"].find(name); found != (*report)["noise"].end() && found->is_number())
        noise = std::max(noise, found->get<double>());
  return noise;
}

/// Whether the values of the repetitions of a and b do not overlap. One flight is one value.
bool areApart(const Json& a, const Json& b, const MeasureField& measure) {
  double least[2], most[2];
  const Json* reports[2] = {&a, &b};
  for (std::size_t i = 0; i < 2; ++i) {
    const Json& report = *reports[i];
    least[i] = most[i] = report["measures"][Json::json_pointer(measure.pointer)].get<double>();
    if (!report.contains("runs") || !report["runs"].is_array()) continue;
    for (const Json& run : report["runs"])
      if (const Json::json_pointer where(measure.pointer); run.contains(where) && run[where].is_number()) {
        least[i] = std::min(least[i], run[where].get<double>());
        most[i] = std::max(most[i], run[where].get<double>());
      }
  }
  return most[0] < least[1] || most[1] < least[0];
}

bool isWorse(const MeasureChange& c, double failAbove) {
  return c.worseBy > failAbove && c.worseBy > c.noise && c.apart;
}

std::string verdictOf(const MeasureChange& c, double failAbove) {
  if (isWorse(c, failAbove)) return "worse";
  if (c.a == c.b) return "equal";
  if (c.noise >= 0.0 && (std::abs(c.ratio - 1.0) <= c.noise || !c.apart)) return "within noise";
  return "";
}

std::string reportFile(const std::string& named) {
  return std::filesystem::is_directory(named) ? named + "/report.json" : named;
}

std::string besideReport(const std::string& named, const std::string& file) {
  return (std::filesystem::path(reportFile(named)).parent_path() / file).string();
}

std::vector<std::string> picturesOf(const Json& report) {
  std::vector<std::string> files;
  if (report.contains("pictures") && report["pictures"].is_array())
    for (const Json& picture : report["pictures"])
      if (picture.is_object() && picture.contains("file") && picture["file"].is_string())
        files.push_back(picture["file"].get<std::string>());
  return files;
}

std::string psnrText(double db) {
  if (std::isnan(db)) return "sizes differ";
  if (std::isinf(db)) return "equal";
  char text[32];
  std::snprintf(text, sizeof text, "%.2f dB", db);
  return text;
}

/// The members of two objects that differ, one line each.
void addDifferences(const Json& a, const Json& b, const std::string& object, const char* ignored,
                    const std::string& prefix, std::vector<std::string>& out) {
  const Json empty = Json::object();
  const Json& left = a.contains(object) && a[object].is_object() ? a[object] : empty;
  const Json& right = b.contains(object) && b[object].is_object() ? b[object] : empty;
  for (const auto& [name, value] : left.items())
    if (name != ignored && right.contains(name) && right[name] != value)
      out.push_back(prefix + name + ": " + textOf(value) + " / " + textOf(right[name]));
}

std::vector<std::string> warningsOf(const Json& a, const Json& b, const Comparison& comparison) {
  std::vector<std::string> warnings;
  constexpr double kBusy = 0.1;
  const Json::json_pointer others("/measures/cpu_of_others");
  const auto busy = [&](const Json& report) {
    return report.contains(others) && report[others].is_number() ? report[others].get<double>() : 0.0;
  };
  if (std::max(busy(a), busy(b)) > kBusy) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "other programs took %.0f %% of the machine's CPU time in A and %.0f %% in B: times mean little",
                  100.0 * busy(a), 100.0 * busy(b));
    warnings.push_back(text);
  }
  if (std::all_of(comparison.changes.begin(), comparison.changes.end(),
                  [](const MeasureChange& c) { return c.noise < 0.0; }))
    warnings.push_back("the noise is not known: fly with --repeat 3");
  return warnings;
}

std::string verdict(const Comparison& comparison, double failAbove) {
  if (!std::isfinite(failAbove)) return {};
  std::string worse;
  for (const MeasureChange& c : comparison.changes)
    if (isWorse(c, failAbove)) worse += (worse.empty() ? "" : ", ") + c.name;
  char limit[32];
  std::snprintf(limit, sizeof limit, "%g", 100.0 * failAbove);
  return worse.empty() ? std::string("B is in nothing worse by more than ") + limit + " % and its noise"
                       : std::string("B is worse by more than ") + limit + " % and its noise: " + worse;
}

}  // namespace

Comparison compareReports(const std::string& fileA, const std::string& jsonA, const std::string& fileB,
                          const std::string& jsonB) {
  const Json a = parseReport(fileA, jsonA);
  const Json b = parseReport(fileB, jsonB);
  Comparison comparison;
  for (const MeasureField& measure : measureFields()) {
    // What only one of them has is of a newer version; the first measure makes a report.
    if (&measure != measureFields().data() && !(has(a, measure) && has(b, measure))) continue;
    comparison.changes.push_back(change(measure, numberAt(fileA, a, measure), numberAt(fileB, b, measure)));
    comparison.changes.back().noise = noiseOf(a, b, measure.name);
    comparison.changes.back().apart = areApart(a, b, measure);
  }
  for (const char* name : {"program", "commit"})
    if (a.contains(name) && b.contains(name) && a[name] != b[name])
      comparison.differences.push_back(std::string(name) + ": " + textOf(a[name]) + " / " + textOf(b[name]));
  for (const char* name : {"backend", "device", "frames"})
    if (a["measures"].contains(name) && b["measures"].contains(name) && a["measures"][name] != b["measures"][name])
      comparison.differences.push_back(std::string(name) + ": " + textOf(a["measures"][name]) + " / " +
                                       textOf(b["measures"][name]));
  addDifferences(a, b, "store", "path", "store's ", comparison.differences);
  addDifferences(a, b, "options", "", "", comparison.differences);
  addDifferences(a, b, "machine", "", "", comparison.differences);
  comparison.warnings = warningsOf(a, b, comparison);
  return comparison;
}

Comparison compareRuns(const std::string& a, const std::string& b) {
  const std::string fileA = reportFile(a);
  const std::string fileB = reportFile(b);
  const std::string jsonA = readText(fileA);
  const std::string jsonB = readText(fileB);
  Comparison comparison = compareReports(fileA, jsonA, fileB, jsonB);
  const std::vector<std::string> inA = picturesOf(Json::parse(jsonA)), inB = picturesOf(Json::parse(jsonB));
  const auto in = [](const std::vector<std::string>& files, const std::string& file) {
    return std::find(files.begin(), files.end(), file) != files.end();
  };
  for (const std::string& file : inA)
    if (in(inB, file))
      comparison.pictures.push_back({file, psnr(readPng(besideReport(a, file)), readPng(besideReport(b, file)))});
    else
      comparison.differences.push_back("pictures: " + file + " is in A alone");
  for (const std::string& file : inB)
    if (!in(inA, file)) comparison.differences.push_back("pictures: " + file + " is in B alone");
  return comparison;
}

std::string comparisonTable(const Comparison& comparison, double failAbove) {
  char line[160];
  std::snprintf(line, sizeof line, "%-24s %14s %14s %8s %8s\n", "measure", "A", "B", "B/A", "noise");
  std::string table = line;
  for (const MeasureChange& c : comparison.changes) {
    char ratio[16] = "-", noise[16] = "-";
    if (std::isfinite(c.ratio)) std::snprintf(ratio, sizeof ratio, "%.3f", c.ratio);
    if (c.noise >= 0.0) std::snprintf(noise, sizeof noise, "%.1f %%", 100.0 * c.noise);
    std::snprintf(line, sizeof line, "%-24s %14.6g %14.6g %8s %8s  %s", c.name.c_str(), c.a, c.b, ratio, noise,
                  verdictOf(c, failAbove).c_str());
    table += line;
    table.erase(table.find_last_not_of(' ') + 1);
    table += "\n";
  }
  for (const PictureChange& p : comparison.pictures) table += p.file + ": " + psnrText(p.psnr) + "\n";
  for (const std::string& difference : comparison.differences) table += "the runs differ in " + difference + "\n";
  for (const std::string& warning : comparison.warnings) table += warning + "\n";
  const std::string end = verdict(comparison, failAbove);
  return end.empty() ? table : table + end + "\n";
}

bool anyWorse(const Comparison& comparison, double failAbove) {
  return std::any_of(comparison.changes.begin(), comparison.changes.end(),
                     [&](const MeasureChange& c) { return isWorse(c, failAbove); });
}

double psnr(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height) return std::numeric_limits<double>::quiet_NaN();
  double squares = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double d =
          static_cast<double>(a.pixels[i] >> (8 * c) & 255) - static_cast<double>(b.pixels[i] >> (8 * c) & 255);
      squares += d * d;
    }
  if (squares == 0.0) return std::numeric_limits<double>::infinity();
  return 10.0 * std::log10(255.0 * 255.0 * 3.0 * static_cast<double>(a.pixels.size()) / squares);
}

std::string comparisonHtml(const std::string& a, const std::string& b, const Comparison& comparison, double failAbove) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\"><title>Two runs – Strata</title><style>"
      ":root{color-scheme:light dark}body{font:16px/1.5 system-ui,\"DejaVu Sans\",sans-serif;max-width:80rem;margin:0 "
      "auto;padding:1.5rem 1rem}table{border-collapse:collapse}td,th{padding:.3rem .8rem .3rem 0;text-align:right;"
      "border-bottom:1px solid #8884;font-variant-numeric:tabular-nums}td:first-child,th:first-child{text-align:left}"
      ".worse{color:#c0392b;font-weight:600}.pair{display:grid;gap:.6rem;grid-template-columns:repeat(auto-fit,"
      "minmax(20rem,1fr));margin:0 0 1.5rem}figure{margin:0}img{width:100%;display:block}h1{font-size:1.5rem}"
      "h2{font-size:1rem}</style></head><body><h1>Two runs</h1><p>A: " +
      htmlEscape(a) + "<br>B: " + htmlEscape(b) +
      "</p><table><tr><th>measure</th><th>A</th><th>B</th><th>B/A</th><th>noise</th><th></th></tr>";
  for (const MeasureChange& c : comparison.changes) {
    char cells[200], noise[16] = "–";
    if (c.noise >= 0.0) std::snprintf(noise, sizeof noise, "%.1f %%", 100.0 * c.noise);
    std::snprintf(cells, sizeof cells, "<td>%.6g</td><td>%.6g</td><td>%.3f</td><td>%s</td>", c.a, c.b, c.ratio, noise);
    const std::string verdict = verdictOf(c, failAbove);
    html += "<tr><td>" + c.name + "</td>" + cells + (verdict == "worse" ? "<td class=\"worse\">" : "<td>") + verdict +
            "</td></tr>\n";
  }
  html += "</table><p>" + htmlEscape(verdict(comparison, failAbove)) + "</p>";
  for (const std::string& warning : comparison.warnings) html += "<p>" + htmlEscape(warning) + ".</p>";
  for (const std::string& difference : comparison.differences)
    html += "<p>The runs differ in " + htmlEscape(difference) + ".</p>";
  for (const PictureChange& picture : comparison.pictures) {
    html += "<h2>" + htmlEscape(picture.file) + ": " + psnrText(picture.psnr) + "</h2><div class=\"pair\">";
    for (const auto& [run, label] : {std::pair{a, "A"}, std::pair{b, "B"}})
      html += "<figure><img alt=\"" + htmlEscape(picture.file) + "\" src=\"data:image/png;base64," +
              base64(encodePng(readPng(besideReport(run, picture.file)))) + "\"><figcaption>" + label +
              "</figcaption></figure>";
    html += "</div>\n";
  }
  return html + "</body></html>\n";
}

}  // namespace strata
