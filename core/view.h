#pragma once
#include <array>
#include <glm/glm.hpp>

#include "core/box.h"

namespace strata {

/// Where an image lies in the larger picture that it is a tile of; pixels. All zero: the image is the whole picture.
struct PictureTile {
  int pictureWidth = 0, pictureHeight = 0;
  int left = 0, top = 0;  ///< of the image's first pixel in the picture

  bool operator==(const PictureTile&) const = default;
};

/// A camera and its image, everything in double so that UTM coordinates do not jitter.
/// Right-handed; the camera looks along target - eye; y of the image points down (row 0 is the top).
struct View {
  glm::dvec3 eye{0.0, -1.0, 0.0};
  glm::dvec3 target{0.0};
  glm::dvec3 up{0.0, 0.0, 1.0};
  double fovY = 1.0471975511965976;  ///< radians
  bool orthographic = false;
  double orthographicHeight = 1.0;  ///< metres seen from top to bottom of the image
  double nearPlane = 0.01;          ///< metres; points nearer than this are not drawn. There is no far plane
  int width = 1920;                 ///< of the image
  int height = 1080;
  PictureTile tile;  ///< fovY and orthographicHeight are those of the whole picture

  bool operator==(const View&) const = default;
};

/// The view of the whole picture that `view` shows a tile of; `view` itself where it shows all of it.
View wholePicture(const View& view);
/// The view of a tile of width x height pixels whose first pixel is (left, top) of `view`. A tile shows what the whole
/// picture shows in its place, pixel for pixel.
View tileOfPicture(const View& view, int left, int top, int width, int height);

/// Orthonormal camera frame. Degenerate input (eye == target, up along the view) falls back to a sane frame.
struct ViewBasis {
  glm::dvec3 right, up, forward;
};
ViewBasis viewBasis(const View& view);

/// Maps world to the image without losing bits: rows give (x*w, y*w, w) of camera-relative positions:
/// pixel = (row0 . d, row1 . d) / w with d = position - eye, w = row2 . d (perspective) or 1 (orthographic);
/// depth (metres along the view direction) = row2 . d always. Pixel (i, j) holds [i, i+1) x [j, j+1).
/// As homogeneous 4-vectors (d, 1): x = row0, y = row1, w = rowW, depth = rowDepth.
struct Projection {
  glm::dvec3 eye;
  glm::dvec4 rowX, rowY, rowW, rowDepth;
};
Projection projection(const View& view);

/// The side planes and the near plane, pointing inwards: dot(plane, (p - eye, 1)) >= 0 inside.
std::array<glm::dvec4, 5> frustumPlanes(const View& view);

/// True when some of `box` (relative to the eye: box - eye) may be inside; never false for a box that is.
bool boxInFrustum(const std::array<glm::dvec4, 5>& planes, const glm::dvec3& minRelative,
                  const glm::dvec3& maxRelative);

/// Pixels that a length of `metres` covers at `depth` metres in front of the eye.
double pixelsAt(const View& view, double metres, double depth);

/// A view that shows all of `box`, seen from `direction` (from the eye towards the box).
View viewOfBox(const Box& box, const glm::dvec3& direction, int width, int height, double fovY);

}  // namespace strata
