#pragma once
#include <bitset>
#include <glm/glm.hpp>
#include <span>

#include "core/draw_options.h"
#include "render/gl/gl_functions.h"
#include "render/plan/grid_transform.h"
#include "render/plan/view_constants.h"
#include "render/shaders/shader_types.h"

namespace strata {

// Views, grids and clip regions in the form in which shaders read them. Boxes, cutouts and planes beyond Clip::kMost
// are left out.

shader::GridRecord gridRecord(const GridTransform& grid);
shader::ViewRecord viewRecord(const ViewConstants& view, const Clip& clip);
/// The numbers of clip boxes, clip planes and cutouts, in this order.
glm::ivec3 clipCounts(const Clip& clip);

// The uniforms of batch.glsl in the program in use.

void setViewUniforms(const GlFunctions& gl, std::span<const ViewConstants> views);
void setClipUniforms(const GlFunctions& gl, const glm::ivec3& clipCounts);
/// Only programs compiled with ShaderVariant::classes have this uniform.
void setClassUniforms(const GlFunctions& gl, const std::bitset<256>& classes);

}  // namespace strata
