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
  double yMin = 0.0, yMax = 1.0;
  std::vector<double> xTicks;  ///< ascending; first and last bound the axis
  std::vector<std::string> xTickLabels;
  std::vector<double> yTicks;
  std::vector<double> yMarks;  ///< dashed lines across, such as a wanted value
};

/// A whole SVG document: the panels row by row, `columns` in a row, and one key of the lines below.
std::string svgFigure(const std::vector<Chart>& charts, int columns);

/// Round steps that hold all of `values`: sets yMin, yMax and yTicks.
void fitYAxis(Chart& chart);

}  // namespace strata::test
