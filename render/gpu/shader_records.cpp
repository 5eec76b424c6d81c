#include "render/gpu/shader_records.h"

#include <algorithm>
#include <functional>
#include <vector>

namespace strata {
namespace {

/// Calls visit(index in the shader's arrays, box) for all boxes and then for all cutouts.
template <typename Boxes, typename Visit>
void forEachClipBox(const Boxes& boxes, const Boxes& cutouts, Visit visit) {
  std::size_t index = 0;
  for (const Boxes& some : {std::cref(boxes), std::cref(cutouts)})
    for (const auto& box : some)
      if (index < Clip::kMost) visit(index++, box);
}

}  // namespace

shader::GridRecord gridRecord(const GridTransform& grid) {
  shader::GridRecord record{};
  record.x = grid.x;
  record.y = grid.y;
  record.depth = grid.depth;
  forEachClipBox(grid.clipBoxes, grid.clipCutouts, [&](std::size_t i, const ClipSteps& box) {
    record.clipLo[i] = glm::vec4(box.lo, 0.0f);
    record.clipHi[i] = glm::vec4(box.hi, 0.0f);
  });
  for (std::size_t i = 0; i < std::min(grid.clipPlanes.size(), Clip::kMost); ++i)
    record.clipPlanes[i] = grid.clipPlanes[i];
  return record;
}

shader::ViewRecord viewRecord(const ViewConstants& c, const Clip& clip) {
  shader::ViewRecord record{};
  std::copy(c.planes.begin(), c.planes.end(), record.planes);
  record.eye = glm::dvec4(c.view.eye, 0.0);
  record.forward = c.projection.rowDepth;
  record.size = {c.pixelsPerMetre, c.cornerStretch, c.view.nearPlane, c.view.orthographic ? 0.0 : 1.0};
  forEachClipBox(clip.boxes, clip.cutouts, [&](std::size_t i, const Box& box) {
    record.clipLo[i] = glm::dvec4(box.min - c.view.eye, 0.0);
    record.clipHi[i] = glm::dvec4(box.max - c.view.eye, 0.0);
  });
  for (std::size_t i = 0; i < std::min(clip.planes.size(), Clip::kMost); ++i)
    record.clipPlanes[i] =
        glm::dvec4(glm::dvec3(clip.planes[i]), glm::dot(clip.planes[i], glm::dvec4(c.view.eye, 1.0)));
  return record;
}

glm::ivec3 clipCounts(const Clip& clip) {
  const std::size_t boxes = std::min(clip.boxes.size(), Clip::kMost);
  return glm::ivec3(
      glm::uvec3(boxes, std::min(clip.planes.size(), Clip::kMost), std::min(clip.cutouts.size(), Clip::kMost - boxes)));
}

void setViewUniforms(const GlFunctions& gl, std::span<const ViewConstants> views) {
  std::vector<glm::vec4> viewports, lenses;
  for (const ViewConstants& view : views) {
    const Viewport port = viewport(view);
    viewports.emplace_back(port.halfWidth, port.halfHeight, port.width, port.height);
    lenses.emplace_back(port.nearDepth, port.perspective ? 1.0f : 0.0f, port.left, port.top);
  }
  const int count = static_cast<int>(views.size());
  gl.Uniform4fv(STRATA_UNIFORM_VIEWPORT, count, &viewports[0].x);
  gl.Uniform4fv(STRATA_UNIFORM_LENS, count, &lenses[0].x);
}

void setClipUniforms(const GlFunctions& gl, const glm::ivec3& clipCounts) {
  gl.Uniform3i(STRATA_UNIFORM_CLIPS, clipCounts.x, clipCounts.y, clipCounts.z);
}

void setClassUniforms(const GlFunctions& gl, const std::bitset<256>& classes) {
  std::uint32_t words[8] = {};
  for (std::size_t c = 0; c < classes.size(); ++c) words[c / 32] |= (classes[c] ? 1u : 0u) << (c % 32);
  gl.Uniform1uiv(STRATA_UNIFORM_CLASSES, 8, words);
}

}  // namespace strata
