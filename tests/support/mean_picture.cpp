#include "tests/support/mean_picture.h"

#include <limits>

namespace strata::test {

std::uint64_t MeanPicture::coveredPixels() const {
  std::uint64_t count = 0;
  for (const std::uint8_t pixel : covered) count += pixel;
  return count;
}

MeanPictureMaker::MeanPictureMaker(const View& view)
    : view_(view),
      projection_(projection(view)),
      pixels_(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height),
              Pixel{.depth = std::numeric_limits<double>::infinity()}) {}

MeanPictureMaker::Pixel* MeanPictureMaker::pixelOf(const glm::dvec3& position, double& depth) {
  const glm::dvec4 d(position - projection_.eye, 1.0);
  depth = glm::dot(projection_.rowDepth, d);
  if (!(depth >= view_.nearPlane && depth > 0.0)) return nullptr;
  const double w = glm::dot(projection_.rowW, d);
  const double column = glm::dot(projection_.rowX, d) / w;
  const double row = glm::dot(projection_.rowY, d) / w;
  if (!(column >= 0.0 && column < view_.width && row >= 0.0 && row < view_.height)) return nullptr;
  return &pixels_[static_cast<std::size_t>(row) * static_cast<std::size_t>(view_.width) +
                  static_cast<std::size_t>(column)];
}

void MeanPictureMaker::addDepth(const glm::dvec3& position) {
  double depth = 0.0;
  Pixel* pixel = pixelOf(position, depth);
  if (pixel != nullptr && depth < pixel->depth) pixel->depth = depth;
}

void MeanPictureMaker::addColour(const glm::dvec3& position, const glm::u8vec3& colour) {
  double depth = 0.0;
  Pixel* pixel = pixelOf(position, depth);
  if (pixel == nullptr || depth > pixel->depth * (1.0 + kDepthShare)) return;
  pixel->sum += glm::vec3(colour);
  ++pixel->count;
}

MeanPicture MeanPictureMaker::finish(const glm::u8vec3& background) const {
  MeanPicture picture;
  picture.width = view_.width;
  picture.height = view_.height;
  picture.colour.reserve(pixels_.size());
  picture.covered.reserve(pixels_.size());
  for (const Pixel& pixel : pixels_) {
    picture.covered.push_back(pixel.count > 0 ? 1 : 0);
    picture.colour.push_back(pixel.count > 0 ? glm::dvec3(pixel.sum) / static_cast<double>(pixel.count)
                                             : glm::dvec3(background));
  }
  return picture;
}

}  // namespace strata::test
