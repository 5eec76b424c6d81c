#include "viewer/bench/compare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "viewer/bench/html_text.h"
#include "viewer/bench/measures.h"
#include "viewer/text_file.h"

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

bool isWorse(const MeasureChange& c, double failAbove) { return c.worseBy > failAbove && c.worseBy > c.noise; }

std::string verdictOf(const MeasureChange& c, double failAbove) {
  if (isWorse(c, failAbove)) return "worse";
  if (c.noise >= 0.0 && std::abs(c.ratio - 1.0) <= c.noise) return "within noise";
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
                    std::vector<std::string>& out) {
  const Json empty = Json::object();
  const Json& left = a.contains(object) && a[object].is_object() ? a[object] : empty;
  const Json& right = b.contains(object) && b[object].is_object() ? b[object] : empty;
  for (const auto& [name, value] : left.items())
    if (name != ignored && right.contains(name) && right[name] != value)
      out.push_back(name + ": " + textOf(value) + " / " + textOf(right[name]));
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
  }
  for (const char* name : {"backend", "device", "frames"})
    if (a["measures"].contains(name) && b["measures"].contains(name) && a["measures"][name] != b["measures"][name])
      comparison.differences.push_back(std::string(name) + ": " + textOf(a["measures"][name]) + " / " +
                                       textOf(b["measures"][name]));
  addDifferences(a, b, "options", "output", comparison.differences);
  addDifferences(a, b, "machine", "", comparison.differences);
  return comparison;
}

Comparison compareRuns(const std::string& a, const std::string& b) {
  const std::string fileA = reportFile(a);
  const std::string fileB = reportFile(b);
  const std::string jsonA = readText(fileA);
  const std::string jsonB = readText(fileB);
  Comparison comparison = compareReports(fileA, jsonA, fileB, jsonB);
  const std::vector<std::string> inB = picturesOf(Json::parse(jsonB));
  for (const std::string& file : picturesOf(Json::parse(jsonA)))
    if (std::find(inB.begin(), inB.end(), file) != inB.end())
      comparison.pictures.push_back({file, psnr(readPng(besideReport(a, file)), readPng(besideReport(b, file)))});
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
  if (std::all_of(comparison.changes.begin(), comparison.changes.end(),
                  [](const MeasureChange& c) { return c.noise < 0.0; }))
    table += "the noise is not known: fly with --repeat 3\n";
  return table;
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
  html += "</table>";
  for (const std::string& difference : comparison.differences)
    html += "<p>The runs differ in " + htmlEscape(difference) + ".</p>";
  for (const PictureChange& picture : comparison.pictures) {
    html += "<h2>" + htmlEscape(picture.file) + ": " + psnrText(picture.psnr) + "</h2><div class=\"pair\">";
    for (const std::string& run : {a, b})
      html += "<figure><img alt=\"" + htmlEscape(picture.file) + "\" src=\"data:image/png;base64," +
              base64(encodePng(readPng(besideReport(run, picture.file)))) + "\"></figure>";
    html += "</div>\n";
  }
  return html + "</body></html>\n";
}

}  // namespace strata
