#pragma once
#include <span>

#include "core/picture.h"
#include "tests/support/mean_picture.h"

namespace strata::test {

/// How close a drawn picture comes to the reference, in the pixels that the reference covers. A pixel that the drawn
/// picture leaves empty counts with its background colour.
struct PictureQuality {
  double covered = 1.0;  ///< share of the pixels in which the drawn picture has a point too
  double psnr = 0.0;     ///< dB, RGB, peak 255; +inf for equal pictures
  double ssim = 0.0;     ///< mean of the SSIM map, luminance
};
PictureQuality pictureQuality(const MeanPicture& reference, const Picture& drawn);

/// The share of the reference's covered pixels in which `drawn` has a point.
double coveredShare(const MeanPicture& reference, const Picture& drawn);

/// The PSNR of two drawn pictures over all pixels, RGB, in dB; +inf when they are equal.
double psnr(const Picture& a, const Picture& b);

/// The SSIM map (Wang, Bovik, Sheikh, Simoncelli 2004: 11 x 11 Gaussian window of sigma 1.5, K1 = 0.01, K2 = 0.03,
/// L = 255) of two grey pictures, row by row; where the window does not fit into the picture it is left at -2.
std::vector<double> ssimMap(std::span<const double> a, std::span<const double> b, int width, int height);

}  // namespace strata::test
