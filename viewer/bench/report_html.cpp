#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/percentile.h"
#include "core/readable.h"
#include "viewer/bench/html_plot.h"
#include "viewer/bench/report.h"
#include "viewer/output/html_text.h"

namespace strata {
namespace {

constexpr int kEmbeddedWidth = 1280;  // pictures are shrunk to this before they are embedded

constexpr const char* kStyle = R"css(
:root{--paper:#fcfbf9;--card:#fff;--ink:#23282e;--soft:#6a727b;--rule:#e4e1db;--a:#2b6c8f;--b:#b3622b;--warn:#a3342b}
@media(prefers-color-scheme:dark){:root{--paper:#16181b;--card:#1d2024;--ink:#e6e4df;--soft:#98a0a8;--rule:#31353a;
--a:#6db3d6;--b:#e09a63;--warn:#e5786e}}
@media print{:root{--paper:#fff;--card:#fff;--ink:#000;--soft:#555;--rule:#ccc;--a:#2b6c8f;--b:#b3622b;--warn:#a3342b}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.55 system-ui,-apple-system,"Segoe UI",Roboto,
"DejaVu Sans",sans-serif;-webkit-text-size-adjust:100%;print-color-adjust:exact;-webkit-print-color-adjust:exact}
main{max-width:60rem;margin:0 auto;padding:2.5rem 1.25rem 4rem}
h1{font-size:1.9rem;line-height:1.2;font-weight:600;margin:0;letter-spacing:-.01em;overflow-wrap:anywhere}
h2{font-size:1.05rem;font-weight:600;margin:3rem 0 1rem;padding-top:1rem;border-top:1px solid var(--rule)}
p{margin:.4rem 0}.soft,small,figcaption{color:var(--soft)}figcaption b{color:var(--ink);font-weight:600}
figure{margin:0}img{display:block;width:100%;height:auto;border-radius:6px}
.pictures{display:grid;gap:1.25rem;grid-template-columns:repeat(auto-fit,minmax(17rem,1fr))}
.strip{grid-template-columns:repeat(auto-fill,minmax(9.5rem,1fr));gap:.9rem}
.hero{margin:1.75rem 0 1.25rem}figcaption{font-size:.85rem;margin:.35rem 0 0}
.figures{display:grid;gap:1px;grid-template-columns:repeat(auto-fill,minmax(9.5rem,1fr));background:var(--card);
border:1px solid var(--rule);border-radius:6px;overflow:hidden;margin:1.75rem 0 0}
.figures div{padding:.8rem 1rem;box-shadow:0 0 0 1px var(--rule)}
.figures b{display:block;font-size:1.35rem;font-weight:600;font-variant-numeric:tabular-nums;white-space:nowrap}
.figures span{font-size:.82rem;color:var(--soft)}
figure.plot{margin:0 0 1.5rem;padding-bottom:1.9rem}.plot figcaption{font-size:.9rem;margin:0 0 .9rem}
.chart{position:relative;height:13rem;margin:0 .4rem 0 4.6rem}
.chart svg{position:absolute;inset:0;width:100%;height:100%;overflow:visible}
.chart span{position:absolute;font-size:.75rem;color:var(--soft);white-space:nowrap;font-variant-numeric:tabular-nums}
.chart .y{right:100%;margin-right:.6rem;transform:translateY(-50%)}
.chart .x{top:100%;margin-top:.4rem;transform:translateX(-50%)}.chart .x:last-child{transform:translateX(-100%)}
svg *{vector-effect:non-scaling-stroke}.grid{stroke:var(--rule);stroke-width:1}
.line{fill:none;stroke-width:1.6;stroke-linejoin:round}.line.a{stroke:var(--a)}.line.b{stroke:var(--b)}
.line.muted{stroke:var(--soft);stroke-dasharray:4 4;stroke-width:1}
.fill{stroke:none;opacity:.13}.fill.a{fill:var(--a)}.fill.b{fill:var(--b)}.mark{stroke:var(--warn);stroke-width:2}
.key{margin-left:.9rem;white-space:nowrap}.key:before{content:"";display:inline-block;width:1.1em;height:0;
border-top:2px solid;margin-right:.4em;vertical-align:middle}.key.a:before{color:var(--a)}.key.b:before{color:var(--b)}
.key.muted:before{border-top-style:dashed;border-top-width:1px}
.stages{display:flex;height:1.1rem;border-radius:4px;overflow:hidden;background:var(--rule);margin:0 0 1rem}
.stages i.k0,i.swatch.k0{background:var(--soft)}.stages i.k1,i.swatch.k1{background:var(--warn)}
.stages i.k2,i.swatch.k2{background:var(--a)}.stages i.k3,i.swatch.k3{background:var(--b)}
i.swatch{display:inline-block;width:.7em;height:.7em;border-radius:2px;margin-right:.5em}
table{border-collapse:collapse;width:100%;font-size:.92rem}
td,th{padding:.38rem .5rem .38rem 0;border-bottom:1px solid var(--rule);text-align:left;vertical-align:top;
font-weight:400;overflow-wrap:anywhere}th{color:var(--soft);width:38%}td.n,th.n{text-align:right;width:auto;
font-variant-numeric:tabular-nums;white-space:nowrap}
.two{display:grid;gap:0 2.5rem;grid-template-columns:repeat(auto-fit,minmax(18rem,1fr))}
footer{margin-top:3rem;font-size:.82rem;color:var(--soft)}
@media(max-width:32rem){main{padding:1.5rem 1rem 3rem}h1{font-size:1.5rem}.chart{height:10rem;margin-left:4.1rem}
.chart .x:nth-of-type(2n+7){display:none}}
@media print{main{max-width:none;padding:0}h2{break-after:avoid}figure,tr,.figures,.stages{break-inside:avoid}body{font-size:10.5pt}}
)css";

/// Each pixel the mean of the ones it stands for.
Image shrunk(const Image& image, int width) {
  if (image.width <= width || image.width <= 0) return image;
  Image small;
  small.width = width;
  small.height = std::max(1, static_cast<int>(static_cast<long long>(image.height) * width / image.width));
  small.pixels.reserve(static_cast<std::size_t>(small.width) * static_cast<std::size_t>(small.height));
  for (int y = 0; y < small.height; ++y) {
    const int y0 = static_cast<int>(static_cast<long long>(y) * image.height / small.height);
    const int y1 = std::max(y0 + 1, static_cast<int>(static_cast<long long>(y + 1) * image.height / small.height));
    for (int x = 0; x < small.width; ++x) {
      const int x0 = static_cast<int>(static_cast<long long>(x) * image.width / small.width);
      const int x1 = std::max(x0 + 1, static_cast<int>(static_cast<long long>(x + 1) * image.width / small.width));
      std::uint32_t sum[4] = {0, 0, 0, 0};
      for (int v = y0; v < y1; ++v)
        for (int u = x0; u < x1; ++u) {
          const std::uint32_t pixel = image.pixels[static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) +
                                                   static_cast<std::size_t>(u)];
          for (int c = 0; c < 4; ++c) sum[c] += pixel >> (8 * c) & 255;
        }
      const std::uint32_t n = static_cast<std::uint32_t>((x1 - x0) * (y1 - y0));
      small.pixels.push_back(sum[0] / n | sum[1] / n << 8 | sum[2] / n << 16 | sum[3] / n << 24);
    }
  }
  return small;
}

std::string pictureHtml(const ReportPicture& picture, const char* style) {
  return std::string("<figure class=\"") + style + "\"><img alt=\"" + htmlEscape(picture.title) +
         "\" src=\"data:image/png;base64," + base64(encodePng(shrunk(picture.image, kEmbeddedWidth))) +
         "\"><figcaption>" + htmlEscape(picture.title) + "</figcaption></figure>\n";
}

/// The first still large, the others beside each other.
std::string stillsHtml(const std::vector<ReportPicture>& pictures) {
  std::string hero, sheet;
  for (const ReportPicture& picture : pictures) {
    if (picture.ofTheFlight || picture.image.pixels.empty()) continue;
    if (hero.empty())
      hero = pictureHtml(picture, "hero");
    else
      sheet += pictureHtml(picture, "small");
  }
  return hero + (sheet.empty() ? "" : "<div class=\"pictures\">" + sheet + "</div>\n");
}

std::string flightPicturesHtml(const std::vector<ReportPicture>& pictures) {
  std::string sheet;
  for (const ReportPicture& picture : pictures)
    if (picture.ofTheFlight && !picture.image.pixels.empty()) sheet += pictureHtml(picture, "small");
  return sheet.empty() ? "" : "<div class=\"pictures strip\">" + sheet + "</div>\n";
}

std::string keyFigures(const BenchMeasures& m) {
  std::string html = "<div class=\"figures\">";
  const auto add = [&](const std::string& value, const char* name) {
    html += "<div><b>" + htmlEscape(value) + "</b><span>" + name + "</span></div>";
  };
  add(readableMs(m.p50Ms), "a frame, median");
  add(readableMs(m.p99Ms), "a frame, 99th percentile");
  add(readableCount(m.pointsPerSecond) + "/s", "points drawn");
  add(readableCount(m.pointsDrawnMean), "points in a frame, mean");
  add(readableMs(m.timeToFullDetailMs), "from nothing to full detail");
  add(readableMs(m.lodMs), "a LOD pass, mean");
  add(readableBytes(static_cast<double>(m.bytesRead)), "read from the store");
  add(readableCount(m.cacheHitRate * 100.0) + " %", "of nodes found in the cache");
  add(std::to_string(m.hitches), "hitches (over 60 ms and 1.5 × the frame before)");
  add(readableCount(m.pointsPerPixelWon), "points drawn for a pixel won");
  add(readableBytes(static_cast<double>(m.peakRssBytes)), "memory, peak");
  add(readableCount(m.spacingP95) + " px", "between points where widest, 95th percentile");
  add(readableCount(100.0 * m.cpuOfOthers) + " %", "of the machine's CPU time taken by other programs");
  return html + "</div>\n";
}

template <class Get>
std::vector<double> column(const std::vector<FrameRecord>& frames, Get get) {
  std::vector<double> values;
  values.reserve(frames.size());
  for (const FrameRecord& frame : frames) values.push_back(static_cast<double>(get(frame)));
  return values;
}

std::string readablePercent(double value) { return readableCount(value) + " %"; }

std::vector<double> cutsOf(const BenchReport& report) {
  std::vector<double> cuts;
  for (const JumpRecord& jump : report.jumps)
    if (jump.t > 0.0) cuts.push_back(jump.t);
  return cuts;
}

/// Picture time against the share of frames that take no longer.
Plot percentilePlot(const std::vector<FrameRecord>& frames) {
  const std::vector<double> times = column(frames, [](const FrameRecord& f) { return f.frameMs; });
  Plot plot{"Picture time by percentile", "The share of frames that took no longer.", {}, {}, {}, readableMs, "%"};
  PlotLine line{"a frame", "a", {}, true};
  for (int p = 0; p <= 200; ++p) {
    plot.x.push_back(p / 2.0);
    line.values.push_back(percentile(times, p / 2.0));
  }
  plot.lines.push_back(std::move(line));
  return plot;
}

std::string plotsHtml(const BenchReport& report) {
  const std::vector<FrameRecord>& frames = report.frames;
  const std::vector<double> t = column(frames, [](const FrameRecord& f) { return f.t; });
  std::vector<double> hitches;
  for (const FrameRecord& frame : frames)
    if (frame.hitch) hitches.push_back(frame.t);
  const auto line = [&](const char* label, const char* style, bool filled, auto get) {
    return PlotLine{label, style, column(frames, get), filled};
  };

  Plot time{"Picture time over the path",
            hitches.empty() ? "" : "Hitches are marked at the top.",
            t,
            {},
            hitches,
            readableMs};
  time.lines.push_back(line("a frame", "a", true, [](const FrameRecord& f) { return f.frameMs; }));
  time.lines.push_back({"99th percentile", "muted", std::vector<double>(t.size(), report.measures.p99Ms), false});
  Plot points{"Points over the path", "Drawn: sent through projection after culling.", t, {}, {}, readableCount};
  points.lines.push_back(line("in the render list", "b", false, [](const FrameRecord& f) { return f.pointsListed; }));
  points.lines.push_back(line("drawn", "a", true, [](const FrameRecord& f) { return f.pointsDrawn; }));
  Plot detail{
      "Detail over the path",
      "Share of the nodes that the view wants and that are drawn as finely; for the rest something coarser stands in.",
      t,
      {},
      cutsOf(report),
      readablePercent};
  detail.top = 100.0;
  detail.lines.push_back(line("detail", "b", true, [](const FrameRecord& f) { return 100.0 * f.detail; }));
  Plot spacing{"Widest distance between points",
               "In pixels, where more points of the store would narrow it and nothing hides it.",
               t,
               {},
               cutsOf(report),
               readableCount};
  spacing.lines.push_back(line("widest", "b", true, [](const FrameRecord& f) { return f.widestSpacingPx; }));
  Plot bytes{"Bytes", "", t, {}, {}, readableBytes};
  bytes.lines.push_back(line("read from the store", "a", true, [](const FrameRecord& f) { return f.bytesRead; }));
  bytes.lines.push_back(line("nodes in memory", "b", false, [](const FrameRecord& f) { return f.residentBytes; }));
  Plot queue{"Nodes waiting to be read", "", t, {}, {}, readableCount};
  queue.lines.push_back(line("load queue", "b", true, [](const FrameRecord& f) { return f.queueLength; }));
  return plotHtml(time) + plotHtml(percentilePlot(frames)) + plotHtml(points) + plotHtml(detail) + plotHtml(spacing) +
         plotHtml(queue) + plotHtml(bytes);
}

/// How fast the picture fills after each jump.
std::string jumpsHtml(const std::vector<JumpRecord>& jumps) {
  std::string rows;
  for (const JumpRecord& jump : jumps) {
    rows += "<tr><td>" + (jump.t > 0.0 ? "cut at " + readableMs(1000.0 * jump.t) : std::string("start")) + "</td>";
    for (const double ms : jump.reachedMs)
      rows += "<td class=\"n\">" + (ms >= 0.0 ? readableMs(ms) : std::string("not reached")) + "</td>";
    rows += "</tr>";
  }
  if (rows.empty()) return rows;
  return "<h2>Until the picture is whole</h2>\n<table><tr><th>after</th><th class=\"n\">80 %</th><th "
         "class=\"n\">95 %</th><th class=\"n\">100 % of the nodes</th></tr>" +
         rows + "</table>\n";
}

/// Each measure's median over the repetitions, and how far it strays; nothing where there was one run.
std::string repetitionsHtml(const BenchReport& report) {
  const std::vector<MeasureNoise> noise = measureNoise(report.runs);
  if (noise.empty()) return {};
  std::string rows;
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const MeasureField& field = measureFields()[i];
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const BenchMeasures& run : report.runs) {
      least = std::min(least, field.get(run));
      most = std::max(most, field.get(run));
    }
    rows += "<tr><td>" + htmlEscape(noise[i].name) + "</td>";
    for (const double value : {field.get(report.measures), least, most}) {
      char number[32];
      std::snprintf(number, sizeof number, "%.4g", value);
      rows += std::string("<td class=\"n\">") + (std::abs(value) >= 1e4 ? readableCount(value) : number) + "</td>";
    }
    rows += "<td class=\"n\">" + readableCount(100.0 * noise[i].share) + " %</td></tr>";
  }
  return "<h2>" + std::to_string(report.runs.size()) +
         " flights</h2>\n<table><tr><th>measure</th><th class=\"n\">median</th><th class=\"n\">least</th><th "
         "class=\"n\">most</th><th class=\"n\">spread</th></tr>" +
         rows + "</table>\n";
}

std::string stagesHtml(const std::vector<FrameStage>& stages) {
  double total = 0.0;
  for (const FrameStage& stage : stages) total += stage.onRenderThread ? stage.meanMs : 0.0;
  std::string bar = "<div class=\"stages\">";
  std::string rows = "<table><tr><th>stage</th><th class=\"n\">mean</th><th class=\"n\">95th percentile</th></tr>";
  for (const FrameStage& stage : stages) {
    std::string colour("k");
    colour += std::to_string(&stage - stages.data());
    if (stage.onRenderThread && total > 0.0)
      bar += "<i class=\"" + colour + "\" title=\"" + htmlEscape(stage.name) +
             "\" style=\"width:" + std::to_string(100.0 * stage.meanMs / total) + "%\"></i>";
    rows += "<tr><td>" + (stage.onRenderThread ? "<i class=\"swatch " + colour + "\"></i>" : std::string()) +
            htmlEscape(stage.name) + (stage.onRenderThread ? "" : " <small>(no part of the sum)</small>") +
            "</td><td class=\"n\">" + readableMs(stage.meanMs) + "</td><td class=\"n\">" + readableMs(stage.p95Ms) +
            "</td></tr>";
  }
  return bar + "</div>" + rows + "</table>\n";
}

std::string factsHtml(const char* title, const std::vector<std::pair<std::string, std::string>>& facts) {
  std::string html = std::string("<section><h2>") + title + "</h2><table>";
  for (const auto& [name, value] : facts)
    html += "<tr><th>" + htmlEscape(name) + "</th><td>" + htmlEscape(value) + "</td></tr>";
  return html + "</table></section>\n";
}

}  // namespace

std::string reportHtml(const BenchReport& report) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>" +
      htmlEscape(report.storeName) + " – Strata</title><style>" + kStyle + "</style></head><body><main>\n<header><h1>" +
      htmlEscape(report.storeName) + "</h1><p class=\"soft\">" + htmlEscape(report.program) + " (" +
      htmlEscape(report.commit) + "), " + htmlEscape(report.when) + ". " + htmlEscape(report.measures.backend) +
      " on " + htmlEscape(report.measures.device) + ".</p></header>\n";
  html += stillsHtml(report.pictures);
  if (report.measures.frames > 0)
    html += keyFigures(report.measures) + "<h2>Along the path</h2>\n" + plotsHtml(report) +
            flightPicturesHtml(report.pictures) + jumpsHtml(report.jumps) + "<h2>Where a frame's time goes</h2>\n" +
            stagesHtml(report.stages) + repetitionsHtml(report);
  const Machine& machine = report.machine;
  std::vector<std::pair<std::string, std::string>> machineFacts{
      {"processor", machine.cpu},
      {"cores for this run", std::to_string(machine.cores)},
      {"memory", readableBytes(static_cast<double>(machine.memory))},
      {"system", machine.system},
      {"rasterizer", report.measures.backend + ", " + report.measures.device}};
  std::vector<std::pair<std::string, std::string>> storeFacts = report.store;
  storeFacts.emplace_back("hash", report.storeHash);
  html += "<div class=\"two\">" + factsHtml("The store", storeFacts) + factsHtml("The machine", machineFacts) +
          factsHtml("This run", report.options);
  std::vector<std::pair<std::string, std::string>> counters;
  for (const auto& [name, value] : report.counters) counters.emplace_back(name, readableCount(value));
  if (!counters.empty()) html += factsHtml("Counters of the streamer", counters);
  return html + "</div>\n<footer>Every figure is in report.json, every frame in frames.csv beside this page.</footer>" +
         "\n</main></body></html>\n";
}

}  // namespace strata
