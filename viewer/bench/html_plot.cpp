#include "viewer/bench/html_plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "viewer/output/html_text.h"

namespace strata {
namespace {

constexpr double kWidth = 1000.0;  // of the drawing's own coordinates; the page stretches it
constexpr double kHeight = 300.0;
constexpr int kGridLines = 4;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

struct Scale {
  double x0, xSpan, top;
  double x(double value) const { return xSpan > 0.0 ? (value - x0) / xSpan * kWidth : 0.0; }
  double y(double value) const { return kHeight - value / top * kHeight; }
};

/// "x,y x,y ..." of one curve, thinned to what the columns can show.
std::string coordinates(std::span<const double> xs, std::span<const double> ys, const Scale& scale) {
  std::string points;
  const auto add = [&](std::size_t i) { points += number(scale.x(xs[i])) + "," + number(scale.y(ys[i])) + " "; };
  const std::size_t count = std::min(xs.size(), ys.size());
  const std::size_t step = std::max<std::size_t>(1, count / kPlotColumns);
  for (std::size_t first = 0; first < count; first += step) {
    const std::size_t end = std::min(first + step, count);
    const auto [low, high] = std::minmax_element(ys.begin() + static_cast<std::ptrdiff_t>(first),
                                                 ys.begin() + static_cast<std::ptrdiff_t>(end));
    const std::size_t a = static_cast<std::size_t>(std::min(low, high) - ys.begin());
    const std::size_t b = static_cast<std::size_t>(std::max(low, high) - ys.begin());
    add(a);
    if (b != a) add(b);
  }
  return points;
}

std::string lineSvg(const PlotLine& line, const Plot& plot, const Scale& scale) {
  const std::string points = coordinates(plot.x, line.values, scale);
  std::string svg;
  if (line.filled)
    svg += "<polygon class=\"fill " + line.style + "\" points=\"" + number(scale.x(plot.x.front())) + "," +
           number(kHeight) + " " + points + number(scale.x(plot.x.back())) + "," + number(kHeight) + "\"/>";
  return svg + "<polyline class=\"line " + line.style + "\" points=\"" + points + "\"/>";
}

std::string axesHtml(const Plot& plot, const Scale& scale) {
  std::string html;
  for (int i = 0; i <= kGridLines; ++i) {
    const double share = static_cast<double>(i) / kGridLines;
    html += "<span class=\"y\" style=\"top:" + number(100.0 - 100.0 * share) + "%\">" +
            htmlEscape(plot.format(scale.top * share)) + "</span>";
  }
  for (int i = 0; i <= kGridLines; ++i) {
    const double share = static_cast<double>(i) / kGridLines;
    html += "<span class=\"x\" style=\"left:" + number(100.0 * share) + "%\">" +
            number(scale.x0 + scale.xSpan * share) + " " + htmlEscape(plot.unit) + "</span>";
  }
  return html;
}

}  // namespace

double niceCeiling(double value) {
  if (!(value > 0.0) || !std::isfinite(value)) return 1.0;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 2.5, 5.0})
    if (value <= step * power * (1.0 + 1e-9)) return step * power;
  return 10.0 * power;
}

std::string plotHtml(const Plot& plot) {
  if (plot.x.empty()) return {};
  double highest = 0.0;
  for (const PlotLine& line : plot.lines)
    for (const double value : line.values) highest = std::max(highest, value);
  const Scale scale{plot.x.front(), plot.x.back() - plot.x.front(), plot.top > 0.0 ? plot.top : niceCeiling(highest)};

  std::string html = "<figure class=\"plot\"><figcaption><b>" + htmlEscape(plot.title) + "</b>";
  for (const PlotLine& line : plot.lines)
    html += " <span class=\"key " + line.style + "\">" + htmlEscape(line.label) + "</span>";
  if (!plot.note.empty()) html += "<br><small>" + htmlEscape(plot.note) + "</small>";
  html += "</figcaption><div class=\"chart\"><svg viewBox=\"0 0 " + number(kWidth) + " " + number(kHeight) +
          "\" preserveAspectRatio=\"none\" role=\"img\" aria-label=\"" + htmlEscape(plot.title) + "\">";
  for (int i = 0; i <= kGridLines; ++i) {
    const std::string y = number(kHeight * i / kGridLines);
    html += "<line class=\"grid\" x1=\"0\" x2=\"" + number(kWidth) + "\" y1=\"" + y + "\" y2=\"" + y + "\"/>";
  }
  for (const PlotLine& line : plot.lines) html += lineSvg(line, plot, scale);
  for (const double mark : plot.marks) {
    const std::string x = number(scale.x(mark));
    html += "<line class=\"mark\" x1=\"" + x + "\" x2=\"" + x + "\" y1=\"0\" y2=\"16\"/>";
  }
  return html + "</svg>" + axesHtml(plot, scale) + "</div></figure>\n";
}

}  // namespace strata
