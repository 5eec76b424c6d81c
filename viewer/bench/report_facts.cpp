#include "viewer/bench/report_facts.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "core/readable.h"
#include "io/file/text_file.h"
#include "viewer/bench/report.h"
#include "viewer/session/colour_names.h"

namespace strata {
namespace {

std::string occlusionName(const OcclusionOptions& occlusion) {
  if (!occlusion.enabled) return "off";
  return occlusion == OcclusionOptions::exact() ? "exact" : "on";
}

template <class Numbers>
std::string numbersText(const Numbers& numbers) {
  std::string text;
  for (const double number : numbers) {
    char one[32];
    std::snprintf(one, sizeof one, "%s%.9g", text.empty() ? "" : " ", number);
    text += one;
  }
  return text;
}

template <class Shapes>
std::string shapesText(const Shapes& shapes) {
  std::string text;
  for (const auto& shape : shapes) text += (text.empty() ? "" : "; ") + numbersText(shape);
  return text.empty() ? "none" : text;
}

}  // namespace

std::string storeName(const std::string& path) {
  std::filesystem::path folder = std::filesystem::path(path).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  return folder.stem().string();
}

Facts storeFacts(const Store& store) {
  const StoreInfo& info = store.info();
  char size[96];
  const glm::dvec3 extent = info.bounds.size();
  std::snprintf(size, sizeof size, "%.6g × %.6g × %.6g m", extent.x, extent.y, extent.z);
  std::string attributes;
  for (const Attribute& attribute : info.layout.attributes())
    attributes += (attributes.empty() ? "" : ", ") + attribute.name;
  std::string sources;
  const std::size_t shown = std::min<std::size_t>(info.sources.size(), 4);
  for (std::size_t i = 0; i < shown; ++i)
    sources += (i == 0 ? "" : ", ") + std::filesystem::path(info.sources[i].path).filename().string() + " (" +
               info.sources[i].format + ")";
  if (info.sources.size() > shown) sources += " and " + std::to_string(info.sources.size() - shown) + " more";
  return {{"points", readableCount(static_cast<double>(info.points))},
          {"nodes", readableCount(static_cast<double>(info.nodes))},
          {"levels", std::to_string(info.levels)},
          {"extent", size},
          {"points.bin", readableBytes(static_cast<double>(store.points().size()))},
          {"attributes", attributes.empty() ? "none" : attributes},
          {"sources", sources.empty() ? "unknown" : sources},
          {"made by", info.program}};
}

Facts optionFacts(const BenchOptions& o, const DrawOptions& draw, const std::string& pageCache) {
  char density[32];
  std::snprintf(density, sizeof density, "%g", o.streamer.selection.pointsPerPixel);
  const auto orElse = [](const std::string& text, const char* otherwise) { return text.empty() ? otherwise : text; };
  return {
      {"path", o.path.empty() ? "none" : std::filesystem::path(o.path).filename().string()},
      {"path hash", o.path.empty() ? "none" : textHash(readText(o.path))},
      {"size", std::to_string(o.size.width) + "x" + std::to_string(o.size.height)},
      {"point budget", readableCount(static_cast<double>(o.streamer.selection.pointBudget))},
      {"progressive", o.progressive.millions > 0.0 ? readableCount(1e6 * o.progressive.millions) + " a frame" : "no"},
      {"points a pixel", density},
      {"point size", std::to_string(draw.pointSize)},
      {"colour", colourName(draw.colour)},
      {"values shown", orElse(numbersText(o.draw.range), "all")},
      {"classes", orElse(o.draw.classes, "all")},
      {"clip boxes", shapesText(o.draw.clipBoxes)},
      {"clip planes", shapesText(o.draw.clipPlanes)},
      {"background", orElse(o.draw.background, "as it is")},
      {"holes filled", o.draw.fill},
      {"occlusion", occlusionName(o.streamer.selection.occlusion)},
      {"shading", draw.shading == Shading::highQuality ? "high quality" : "plain"},
      {"eye-dome lighting", draw.edl ? "yes" : "no"},
      {"loader threads", std::to_string(o.streamer.loaderThreads)},
      {"cache", readableBytes(static_cast<double>(o.streamer.cacheBytes))},
      {"frames wait for detail", o.settle ? "yes" : "no"},
      {"repetitions", std::to_string(o.repeat)},
      {"page cache", pageCache}};
}

}  // namespace strata
