// The arithmetic of plan/grid_transform.h.
layout(std430, binding = STRATA_BINDING_PAGE) readonly buffer Page { uint page[]; };
layout(std430, binding = STRATA_BINDING_RECORDS) readonly buffer Records { BatchRecord records[]; };
layout(std430, binding = STRATA_BINDING_BATCH_VIEWS) readonly buffer BatchViews { BatchView batchViews[]; };
layout(std430, binding = STRATA_BINDING_GRIDS) readonly buffer Grids { GridRecord grids[]; };

layout(location = STRATA_UNIFORM_VIEWPORT) uniform vec4 viewports[STRATA_VIEWS];
layout(location = STRATA_UNIFORM_LENS) uniform vec4 lenses[STRATA_VIEWS];
layout(location = STRATA_UNIFORM_CLASSES) uniform uint classes[8];
layout(location = STRATA_UNIFORM_CLIPS) uniform ivec3 clips;

/// One batch as one view sees it, unpacked.
struct Seen {
  vec4 x, y, depth;
  ivec3 offset;
  uvec3 left, right;  // shifts, of which one is 0
  int planes;         // 0: not seen
  int grid;           // -1: its points need no test against the clip region
};

Seen seenBy(uint record, int view) {
  ivec4 offset = batchViews[record * STRATA_VIEWS + view].offset;
  ivec4 shift = batchViews[record * STRATA_VIEWS + view].shift;
  int grid = shift.w >> 1;
  Seen seen;
  seen.x = grids[grid].x;
  seen.y = grids[grid].y;
  seen.depth = grids[grid].depth;
  seen.offset = offset.xyz;
  seen.left = uvec3(max(shift.xyz, ivec3(0)));
  seen.right = uvec3(max(-shift.xyz, ivec3(0)));
  seen.planes = offset.w;
  seen.grid = (shift.w & STRATA_CLIPPED) != 0 ? grid : -1;
  return seen;
}

uvec3 appendBits(uvec3 cell, uint word) { return cell << 10 | (uvec3(word, word >> 10, word >> 20) & 1023u); }

float along(vec4 row, vec3 d) { return fma(d.x, row.x, fma(d.y, row.y, fma(d.z, row.z, row.w))); }

/// d, the grid steps from E. `words` has one word per plane.
vec3 gridSteps(Seen seen, uvec3 words) {
  uvec3 cell = appendBits(uvec3(0u), words.x);
  if (seen.planes > 1) cell = appendBits(cell, words.y);
  if (seen.planes > 2) cell = appendBits(cell, words.z);
  return vec3(ivec3(cell << seen.left >> seen.right) + seen.offset);
}

/// Column and row in pixels of the whole picture, and depth in metres.
vec3 project(Seen seen, int view, vec3 d) {
  float depth = along(seen.depth, d);
  float inverse = lenses[view].y != 0.0 ? 1.0 / depth : 1.0;
  return vec3(fma(along(seen.x, d), inverse, viewports[view].x), fma(along(seen.y, d), inverse, viewports[view].y),
              depth);
}

/// True when a projected point lies in the image and not in front of the near plane.
bool inImage(int view, vec3 projected) {
  return projected.z >= lenses[view].x && all(greaterThanEqual(projected.xy, lenses[view].zw)) &&
         all(lessThan(projected.xy, lenses[view].zw + viewports[view].zw));
}

bool inClipBox(int grid, int i, vec3 d) {
  return all(greaterThanEqual(d, grids[grid].clipLo[i].xyz)) && all(lessThanEqual(d, grids[grid].clipHi[i].xyz));
}

/// True when DrawOptions::clip keeps the point. Its boxes, cutouts and planes are in steps of the grid.
bool keptByClip(int grid, vec3 d) {
  bool kept = clips.x == 0;
  for (int i = 0; i < clips.x; ++i) kept = kept || inClipBox(grid, i, d);
  for (int i = clips.x; i < clips.x + clips.z; ++i) kept = kept && !inClipBox(grid, i, d);
  for (int i = 0; i < clips.y; ++i) kept = kept && along(grids[grid].clipPlanes[i], d) >= 0.0;
  return kept;
}

/// True when DrawOptions::classes has the class in byte `lane` of `word`.
bool keptByClass(uint word, uint lane) {
  uint c = word >> (8u * lane) & 255u;
  return (classes[c >> 5] >> (c & 31u) & 1u) != 0u;
}
