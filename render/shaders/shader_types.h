// Read by C++ and by GLSL: layouts (std430), bindings and uniform locations are written here once.
#ifndef STRATA_RENDER_SHADER_TYPES_H
#define STRATA_RENDER_SHADER_TYPES_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>

namespace strata::shader {
using uint = std::uint32_t;
using vec4 = glm::vec4;
using ivec4 = glm::ivec4;
#endif

#define STRATA_GROUP_SIZE 128  // threads of the work-group that draws one batch (Schütz 2022, 3.2)

#define STRATA_BINDING_PAGE 0     // words of node data
#define STRATA_BINDING_RECORDS 1  // BatchRecord
#define STRATA_BINDING_DEPTH 2    // per pixel: bits of the smallest depth
#define STRATA_BINDING_ID 3       // per pixel: the lowest id at that depth

#define STRATA_UNIFORM_VIEWPORT 0      // half width, half height, width, height in pixels
#define STRATA_UNIFORM_LENS 1          // near plane in metres, 1 for perspective or 0
#define STRATA_UNIFORM_FIRST_RECORD 2  // of the first work-group
#define STRATA_UNIFORM_INDEX_PASS 3    // 0: depth pass, 1: index pass
#define STRATA_UNIFORM_ROWS 4          // first and end row of the image that the buffers hold

#define STRATA_ATTRIBUTE_RECORD 0

/// One batch as a shader draws it; see batch_plan.h for the arithmetic.
struct BatchRecord {
  vec4 x;  // xyz: step a cell, w: base
  vec4 y;
  vec4 depth;
  ivec4 offset;      // w: planes to read, 1 to 3
  ivec4 shift;       // to the right where negative; w: unused
  uint firstWord;    // of plane 0 in the page
  uint planeStride;  // words from one plane to the next
  uint pointCount;
  uint firstId;
};

#ifdef __cplusplus
static_assert(sizeof(BatchRecord) == 96, "std430 has no padding here");
}  // namespace strata::shader
#endif
#endif
