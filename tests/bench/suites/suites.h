#pragma once
#include <string>

#include "render/create_rasterizer.h"

namespace strata::suite {

/// The options of a suite: the experiments of one paper, repeated on synthetic scans of the same kind.
struct SuiteOptions {
  double scale = 0.0;  ///< share of the paper's numbers of points; 0: 1 on a GPU, 0.02 without
  std::string folder;  ///< kanzok leaves its stores and pictures here; empty: nothing is left
  Backend backend = Backend::automatic;
  int width = 0,
      height = 0;  ///< of the pictures; 0: as in the paper, or 1920 x 1080 for kanzok, whose paper has no size
};

// Each prints its paper's tables as Markdown: the rows of this machine beside those of the paper with its hardware.
// Throws Error when a rasterizer, the converter or the disk fails.

/// Kanzok, Linsen, Rosenthal 2015: views of an outdoor and an indoor scan, with and without the occlusion test.
void runKanzok(const SuiteOptions& options);
/// Schütz, Kerbl, Wimmer 2022: unstructured clouds, LOD, the order of points, precision.
void runSchuetz(const SuiteOptions& options);
/// Günther, Kanzok, Linsen, Rosenthal 2013: a stack of planes and a building.
void runGuenther(const SuiteOptions& options);

}  // namespace strata::suite
