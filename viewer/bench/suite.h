#pragma once
#include <string>

#include "render/create_rasterizer.h"
#include "viewer/session/drawing.h"

namespace strata {

/// An experiment of a paper, repeated on synthetic scans of the same kind.
struct SuiteOptions {
  std::string name;    ///< "kanzok", "schuetz" or "guenther"
  double scale = 0.0;  ///< share of the paper's numbers of points; 0: 1 on a GPU, 0.02 without
  std::string folder;  ///< kanzok's stores and pictures are left here; empty: nothing is left
  Backend backend = Backend::automatic;
  PictureSize size{0, 0};  ///< 0: as in the paper; 1920 x 1080 for kanzok, whose paper does not say
};

/// Prints the paper's tables as Markdown, this machine's rows beside those of the paper with its hardware. Throws Error
/// where a rasterizer, the converter or the disk fails.
void runSuite(const SuiteOptions& options);

}  // namespace strata
