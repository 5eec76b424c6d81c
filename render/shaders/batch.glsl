// The transform of batch_plan.h.
layout(std430, binding = STRATA_BINDING_PAGE) readonly buffer Page { uint page[]; };
layout(std430, binding = STRATA_BINDING_RECORDS) readonly buffer Records { BatchRecord records[]; };

layout(location = STRATA_UNIFORM_VIEWPORT) uniform vec4 viewport;
layout(location = STRATA_UNIFORM_LENS) uniform vec2 lens;

uvec3 appendBits(uvec3 cell, uint word) { return cell << 10 | (uvec3(word, word >> 10, word >> 20) & 1023u); }

/// Bits of the coordinates of one point, as many as the batch's precision has.
uvec3 pointCell(uint firstWord, uint planeStride, int planes, uint point) {
  uint word = firstWord + point;
  uvec3 cell = appendBits(uvec3(0u), page[word]);
  if (planes > 1) cell = appendBits(cell, page[word + planeStride]);
  if (planes > 2) cell = appendBits(cell, page[word + 2u * planeStride]);
  return cell;
}

float along(vec4 row, vec3 d) { return fma(d.x, row.x, fma(d.y, row.y, fma(d.z, row.z, row.w))); }

/// Grid steps from the eye's cell: d of batch_plan.h.
vec3 gridSteps(uvec3 cell, ivec3 offset, ivec3 shift) {
  return vec3(ivec3(cell << uvec3(max(shift, ivec3(0))) >> uvec3(max(-shift, ivec3(0)))) + offset);
}

/// Column and row in pixels, depth in metres.
vec3 project(vec4 rowX, vec4 rowY, vec4 rowDepth, vec3 d) {
  float depth = along(rowDepth, d);
  float inverse = lens.y != 0.0 ? 1.0 / depth : 1.0;
  return vec3(fma(along(rowX, d), inverse, viewport.x), fma(along(rowY, d), inverse, viewport.y), depth);
}

bool inImage(vec3 place) {
  return place.z >= lens.x && all(greaterThanEqual(place.xy, vec2(0.0))) && all(lessThan(place.xy, viewport.zw));
}
