#include "tests/support/svg_chart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace strata::test {
namespace {

// All lengths are in SVG user units.
constexpr double kPanelWidth = 360.0, kPanelHeight = 250.0;
constexpr double kLeft = 52.0, kRight = 12.0, kTop = 30.0, kBottom = 44.0;
constexpr double kKeyRow = 20.0;
constexpr const char* kColours[] = {"#0b6fb8", "#d1495b", "#3a8f3a", "#e0952b", "#7b52ab", "#4f5d6b", "#17a2a2"};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

std::string tick(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string text(double x, double y, const std::string& anchor, const std::string& what, const std::string& more = {}) {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\"" + more + ">" + what +
         "</text>\n";
}

std::string line(double x1, double y1, double x2, double y2, const std::string& style) {
  return "<line x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) + "\" y2=\"" + number(y2) +
         "\" " + style + "/>\n";
}

struct Scales {
  const Chart& chart;
  double x(double value) const {
    const double low = std::log(chart.xTicks.front()), high = std::log(chart.xTicks.back());
    return kLeft + (std::log(value) - low) / (high - low) * (kPanelWidth - kLeft - kRight);
  }
  double y(double value) const {
    const double share = (std::clamp(value, chart.yMin, chart.yMax) - chart.yMin) / (chart.yMax - chart.yMin);
    return kPanelHeight - kBottom - share * (kPanelHeight - kTop - kBottom);
  }
};

std::string panel(const Chart& chart, const std::vector<std::string>& labels) {
  const Scales scale{chart};
  std::string svg = text(kLeft, 18, "start", chart.title, " font-weight=\"bold\"");
  for (const double value : chart.yTicks) {
    svg += line(kLeft, scale.y(value), kPanelWidth - kRight, scale.y(value), "stroke=\"#dddddd\"");
    svg += text(kLeft - 6, scale.y(value) + 4, "end", tick(value));
  }
  for (const double value : chart.yMarks)
    svg += line(kLeft, scale.y(value), kPanelWidth - kRight, scale.y(value),
                "stroke=\"#333333\" stroke-dasharray=\"5 4\"");
  const double bottom = kPanelHeight - kBottom;
  for (std::size_t i = 0; i < chart.xTicks.size(); ++i) {
    svg += line(scale.x(chart.xTicks[i]), bottom, scale.x(chart.xTicks[i]), bottom + 5, "stroke=\"#555555\"");
    svg += text(scale.x(chart.xTicks[i]), bottom + 19, "middle", chart.xTickLabels[i]);
  }
  svg += line(kLeft, bottom, kPanelWidth - kRight, bottom, "stroke=\"#555555\"");
  svg += text(0.5 * (kLeft + kPanelWidth - kRight), kPanelHeight - 8, "middle", chart.xLabel);
  svg += text(0, 0, "middle", chart.yLabel,
              " transform=\"translate(13 " + number(0.5 * (kTop + bottom)) + ") rotate(-90)\"");
  for (const ChartLine& curve : chart.lines) {
    const auto known = std::find(labels.begin(), labels.end(), curve.label) - labels.begin();
    const std::string colour = kColours[static_cast<std::size_t>(known) % std::size(kColours)];
    std::string points;
    for (std::size_t i = 0; i < curve.x.size(); ++i)
      points += number(scale.x(curve.x[i])) + "," + number(scale.y(curve.y[i])) + " ";
    svg += "<polyline fill=\"none\" stroke-width=\"1.8\" stroke=\"" + colour + "\" points=\"" + points + "\"/>\n";
    for (std::size_t i = 0; i < curve.x.size(); ++i)
      svg += "<circle r=\"2.6\" fill=\"" + colour + "\" cx=\"" + number(scale.x(curve.x[i])) + "\" cy=\"" +
             number(scale.y(curve.y[i])) + "\"/>\n";
  }
  return svg;
}

double keyWidth(const std::string& label) { return 44.0 + 7.0 * static_cast<double>(label.size()); }

int keyRows(const std::vector<std::string>& labels, double width) {
  int count = 1;
  double x = kLeft;
  for (const std::string& label : labels) {
    if (x > kLeft && x + keyWidth(label) > width) x = kLeft, ++count;
    x += keyWidth(label);
  }
  return count;
}

}  // namespace

void fitYAxis(Chart& chart) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const ChartLine& curve : chart.lines)
    for (const double value : curve.y) {
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  if (!(high > low)) high = low + 1.0;
  const double rough = (high - low) / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * power;
  for (const double factor : {5.0, 2.0, 1.0})
    if (rough <= factor * power) step = factor * power;
  chart.yMin = std::floor(low / step) * step;
  chart.yMax = std::ceil(high / step) * step;
  chart.yTicks.clear();
  for (int i = 0; chart.yMin + i * step <= chart.yMax + 0.5 * step; ++i) chart.yTicks.push_back(chart.yMin + i * step);
}

std::string svgFigure(const std::vector<Chart>& charts, int columns) {
  std::vector<std::string> labels;
  for (const Chart& chart : charts)
    for (const ChartLine& curve : chart.lines)
      if (std::find(labels.begin(), labels.end(), curve.label) == labels.end()) labels.push_back(curve.label);
  const int rows = (static_cast<int>(charts.size()) + columns - 1) / columns;
  const std::string width = number(columns * kPanelWidth);
  const std::string height = number(rows * kPanelHeight + keyRows(labels, columns * kPanelWidth) * kKeyRow + 8.0);
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + width + " " + height + "\" width=\"" +
                    width + "\" height=\"" + height +
                    "\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#222222\">\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  for (std::size_t i = 0; i < charts.size(); ++i) {
    const auto column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
    svg += "<g transform=\"translate(" + number(column * kPanelWidth) + " " + number(row * kPanelHeight) + ")\">\n" +
           panel(charts[i], labels) + "</g>\n";
  }
  double x = kLeft, y = rows * kPanelHeight + kKeyRow - 6.0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const double wide = keyWidth(labels[i]);
    if (x > kLeft && x + wide > columns * kPanelWidth) x = kLeft, y += kKeyRow;
    svg += "<rect x=\"" + number(x) + "\" y=\"" + number(y - 5.0) + "\" width=\"18\" height=\"4\" fill=\"" +
           kColours[i % std::size(kColours)] + "\"/>\n";
    svg += text(x + 24.0, y + 2.0, "start", labels[i]);
    x += wide;
  }
  return svg + "</svg>\n";
}

}  // namespace strata::test
