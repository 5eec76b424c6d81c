#pragma once
#include <span>
#include <string>
#include <vector>

namespace strata {

/// A curve over the path. `style` is a class of the report's style sheet: "a", "b" or "muted".
struct PlotLine {
  std::string label;
  std::string style;
  std::vector<double> values;  ///< one for each x
  bool filled = false;         ///< down to zero
};

struct Plot {
  std::string title;
  std::string note;       ///< one sentence under the title, may be empty
  std::vector<double> x;  ///< ascending
  std::vector<PlotLine> lines;
  std::vector<double> marks;                ///< x of upright ticks at the top
  std::string (*format)(double) = nullptr;  ///< writes the y labels
  std::string unit = "s";                   ///< of x
  double top = 0.0;                         ///< y at the upper edge; 0 = a round number above the highest value
};

/// A <figure> with an inline SVG. Labels are HTML beside the drawing, so they keep their size on a phone.
/// More points than kPlotColumns are drawn as the lowest and highest of each column, so no peak is lost.
inline constexpr int kPlotColumns = 700;
std::string plotHtml(const Plot& plot);

/// The smallest of 1, 2, 2.5 and 5 times a power of ten that is not below `value`; 1 when `value` is not positive.
double niceCeiling(double value);

}  // namespace strata
