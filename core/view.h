#pragma once
#include <array>
#include <glm/glm.hpp>

#include "core/box.h"

namespace strata {

/// The place of a tile in its picture, in pixels. All values are zero for a view of a whole picture.
struct PictureTile {
  int pictureWidth = 0, pictureHeight = 0;
  int left = 0, top = 0;  ///< the tile's first pixel in the picture

  bool operator==(const PictureTile&) const = default;
};

/// A camera and the size of its picture, all in double so that UTM coordinates do not jitter. The frame is
/// right-handed; the camera looks along target - eye; y of the picture points down, and row 0 is the top.
struct View {
  glm::dvec3 eye{0.0, -1.0, 0.0};
  glm::dvec3 target{0.0};
  glm::dvec3 up{0.0, 0.0, 1.0};
  double fovY = 1.0471975511965976;  ///< radians
  bool orthographic = false;
  double orthographicHeight = 1.0;  ///< metres between the top and the bottom of the picture
  double nearPlane = 0.01;          ///< metres; points nearer than this are not drawn. There is no far plane
  int width = 1920;                 ///< pixels of the picture, or of its tile
  int height = 1080;
  PictureTile tile;  ///< for a tile, fovY and orthographicHeight are still those of the whole picture

  bool operator==(const View&) const = default;
};

/// The view of the whole picture that `view` shows a tile of; `view` itself if it shows all of it.
View wholePicture(const View& view);
/// The view of a tile of width x height pixels whose first pixel is (left, top) of `view`. A tile shows what the whole
/// picture shows in its place, pixel for pixel.
View tileOfPicture(const View& view, int left, int top, int width, int height);

/// The orthonormal frame of a camera. Degenerate views (eye == target, up along the view) get a usable one too.
struct ViewBasis {
  glm::dvec3 right, up, forward;
};
ViewBasis viewBasis(const View& view);

/// Maps world coordinates to the picture without losing bits. With d = (position - eye, 1) and w = rowW . d:
///   pixel = (rowX . d, rowY . d) / w;  pixel (i, j) is [i, i+1) x [j, j+1)
///   depth = rowDepth . d, metres along the view direction; w is the depth in perspective, 1 in an orthographic view
struct Projection {
  glm::dvec3 eye;
  glm::dvec4 rowX, rowY, rowW, rowDepth;
};
Projection projection(const View& view);

/// The four side planes and the near plane, with normals of length 1 that point inwards: dot(plane, (p - eye, 1)) >= 0
/// for a point p inside.
std::array<glm::dvec4, 5> frustumPlanes(const View& view);

/// False only when the box, given relative to the eye, lies wholly outside of the planes.
bool boxInFrustum(const std::array<glm::dvec4, 5>& planes, const glm::dvec3& minRelative,
                  const glm::dvec3& maxRelative);

/// The number of pixels that a length of `metres` covers at `depth` metres in front of the eye.
double pixelsAt(const View& view, double metres, double depth);

/// A view that shows all of `box`; `direction` points from the eye towards the box.
View viewOfBox(const Box& box, const glm::dvec3& direction, int width, int height, double fovY);

}  // namespace strata
