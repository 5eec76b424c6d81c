#pragma once
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/type_precision.hpp>

#include "core/view.h"

namespace strata::test {

/// A picture with more than 8 bits per channel. Row 0 is on top.
struct MeanPicture {
  int width = 0;
  int height = 0;
  std::vector<glm::dvec3> colour;     ///< 0 to 255
  std::vector<std::uint8_t> covered;  ///< 1 where a point lies, 0 where `colour` is the background

  std::uint64_t coveredPixels() const;
};

/// Computes what a scan looks like when all of its points are drawn. Each pixel is the plain average of the points that
/// fall into it and lie within 1 % of its front depth (the blending of Schütz 2021, written plainly, in double). Points
/// are added twice, in any order, so that none has to be kept:
///   for every point: addDepth();  for every point: addColour();  finish()
class MeanPictureMaker {
 public:
  static constexpr double kDepthShare = 0.01;

  explicit MeanPictureMaker(const View& view);

  void addDepth(const glm::dvec3& position);
  void addColour(const glm::dvec3& position, const glm::u8vec3& colour);
  MeanPicture finish(const glm::u8vec3& background) const;

 private:
  struct Pixel {
    double depth;
    glm::vec3 sum{0.0f};  ///< of integers, exact up to 65793 points
    std::uint32_t count = 0;
  };

  Pixel* pixelOf(const glm::dvec3& position, double& depth);

  View view_;
  Projection projection_;
  std::vector<Pixel> pixels_;
};

}  // namespace strata::test
