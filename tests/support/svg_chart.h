#pragma once
#include <string>
#include <vector>

namespace strata::test {

struct ChartLine {
  std::string label;  ///< the same label has the same colour in all panels of a figure
  std::vector<double> x, y;
};

/// One panel of a figure: lines with markers over a logarithmic x axis.
struct Chart {
  std::string title;
  std::string xLabel, yLabel;
  std::vector<ChartLine> lines;
  double yMin = 0.0, yMax = 1.0;  ///< ends of the axis
  std::vector<double> xTicks;     ///< ascending; the first and the last are the ends of the axis
  std::vector<std::string> xTickLabels;
  std::vector<double> yTicks;
  std::vector<double> yMarks;  ///< heights of dashed lines, such as a value to be reached
};

/// A whole SVG document: the panels row by row, `columns` in each row, and below them one key for the lines of all.
std::string svgFigure(const std::vector<Chart>& charts, int columns);

/// Sets yMin, yMax and yTicks so that the axis has round steps and holds the values of all lines.
void fitYAxis(Chart& chart);

}  // namespace strata::test
