#pragma once
#include <string>
#include <vector>

#include "core/image.h"

namespace strata {

/// One measure of two runs, a and b.
struct MeasureChange {
  std::string name;
  double a = 0.0, b = 0.0;
  double ratio = 1.0;    ///< b / a
  double worseBy = 0.0;  ///< share by which b is worse than a, 0.05 = 5 %; negative = better; 0 where neither is better
  double noise = -1.0;   ///< share by which the measure strays over the repetitions of a and b; -1 = not known
  bool apart = true;     ///< the ranges of their repetitions do not overlap
};

struct PictureChange {
  std::string file;
  double psnr = 0.0;  ///< dB over red, green and blue; infinite when equal, NaN when the sizes differ
};

/// The differences between two runs.
struct Comparison {
  std::vector<MeasureChange> changes;
  std::vector<std::string> differences;  ///< facts and options that differ, as in "backend: cpu / points"
  std::vector<PictureChange> pictures;   ///< for the files that both reports name
  std::vector<std::string> warnings;     ///< reasons not to trust the comparison
};

/// Compares two report.json texts, without the pictures. Throws Error naming `fileA` or `fileB` when one is no report.
Comparison compareReports(const std::string& fileA, const std::string& jsonA, const std::string& fileB,
                          const std::string& jsonB);

/// Compares two runs by their folders or report.json files, pictures included.
Comparison compareRuns(const std::string& a, const std::string& b);

/// `failAbove` is a share. A measure counts as worse when it is worse by more than that share and by more than its
/// noise, and when every repetition of b is worse than all repetitions of a.
std::string comparisonTable(const Comparison& comparison, double failAbove);
bool anyWorse(const Comparison& comparison, double failAbove);

/// One page without references: the table, and each pair of pictures side by side.
std::string comparisonHtml(const std::string& a, const std::string& b, const Comparison& comparison, double failAbove);

/// Peak signal to noise ratio in dB over red, green and blue of two 8-bit pictures; infinite for equal ones, NaN when
/// the sizes differ.
double psnr(const Image& a, const Image& b);

}  // namespace strata
