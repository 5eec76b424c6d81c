#pragma once
#include <string>
#include <vector>

#include "core/image.h"

namespace strata {

/// One measure of two runs. `ratio` is b / a.
struct MeasureChange {
  std::string name;
  double a = 0.0, b = 0.0;
  double ratio = 1.0;
  double worseBy = 0.0;  ///< share by which b is worse than a, 0.05 = 5 %; negative = better; 0 where neither is better
  double noise = -1.0;   ///< share by which the measure strays over the repetitions of a and b; -1 = not known
  bool apart = true;     ///< no repetition of one lies among those of the other
};

struct PictureChange {
  std::string file;
  double psnr = 0.0;  ///< dB over red, green and blue; infinite when equal, NaN when the sizes differ
};

/// Two runs beside each other.
struct Comparison {
  std::vector<MeasureChange> changes;
  std::vector<std::string> differences;  ///< "backend: cpu / points": what makes the runs unlike
  std::vector<PictureChange> pictures;   ///< of the files that both reports name
  std::vector<std::string> warnings;     ///< what keeps the runs from being compared well
};

/// Compares two report.json texts, but for the pictures. Throws Error naming `fileA` or `fileB` when one is no report.
Comparison compareReports(const std::string& fileA, const std::string& jsonA, const std::string& fileB,
                          const std::string& jsonB);

/// Compares what two runs left in their folders (or report.json files), pictures included.
Comparison compareRuns(const std::string& a, const std::string& b);

/// `failAbove` is a share. Worse is what is worse by more than that and by more than its noise, and in each repetition
/// of b worse than in any of a.
std::string comparisonTable(const Comparison& comparison, double failAbove);
bool anyWorse(const Comparison& comparison, double failAbove);

/// One page without references: the table, and each pair of pictures side by side.
std::string comparisonHtml(const std::string& a, const std::string& b, const Comparison& comparison, double failAbove);

/// Peak signal to noise ratio in dB over red, green and blue of two 8-bit pictures; infinite for equal ones, NaN where
/// the sizes differ.
double psnr(const Image& a, const Image& b);

}  // namespace strata
