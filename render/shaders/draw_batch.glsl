// One work-group draws one batch (Schütz 2022, 3.2). A thread takes four neighbouring points at a time, with one
// 128-bit load per plane (3.4). The shader that includes this defines visit(), which draws a point.
layout(local_size_x = STRATA_GROUP_SIZE) in;

layout(std430, binding = STRATA_BINDING_PAGE) readonly buffer PageOfFours { uvec4 fours[]; };

layout(location = STRATA_UNIFORM_PIXELS) uniform ivec3 pixelsOfView[STRATA_VIEWS];
layout(location = STRATA_UNIFORM_FIRST_RECORD) uniform uint firstRecord;

BatchRecord batch;
Seen seen[STRATA_VIEWS];
int planes = 0;  // the most that any view reads

void beginBatch() {
  uint record = firstRecord + gl_WorkGroupID.x;
  batch = records[record];
  for (int view = 0; view < STRATA_VIEWS; ++view) {
    seen[view] = seenBy(record, view);
    planes = max(planes, seen[view].planes);
  }
}

/// Returns the index of the pixel that a point falls on, and the bits of its depth; -1 where it is not drawn.
int pixelOf(int view, uvec3 words, out uint depth) {
  depth = 0u;
  vec3 d = gridSteps(seen[view], words);
  vec3 projected = project(seen[view], view, d);
  if (!inImage(view, projected)) return -1;
#if STRATA_VIEWS > 1
  if (seen[view].planes == 0) return -1;
#endif
  int row = int(projected.y) - int(lenses[view].w);
  if (row < pixelsOfView[view].y || row >= pixelsOfView[view].z) return -1;
#if STRATA_CLIP
  if (seen[view].grid >= 0 && !keptByClip(seen[view].grid, d)) return -1;
#endif
  depth = floatBitsToUint(projected.z);
  return pixelsOfView[view].x + (row - pixelsOfView[view].y) * int(viewports[view].z) + int(projected.x) -
         int(lenses[view].z);
}

/// Draws a point of the batch. True where it may be the one that its pixel shows.
bool visit(uvec3 words, uint point);

uint visitOne(uvec3 words, uint point, uint classWord, uint lane) {
  if (point >= batch.pointCount) return 0u;
#if STRATA_CLASSES
  if (batch.firstClass != 0u && !keptByClass(classWord, lane)) return 0u;
#endif
  return visit(words, point) ? 1u << lane : 0u;
}

/// The number of points in front of the batch's first that lie in the same four words.
uint pointsBefore() { return batch.firstWord & 3u; }

/// Visits the four points that begin `at` points behind the first whole four. Returns a bit for each that visit() is
/// true for.
uint visitFour(uint at) {
  uint word = (batch.firstWord + at) >> 2, stride = batch.planeStride >> 2;
  uvec4 low = fours[word], medium = uvec4(0u), high = uvec4(0u);
  if (planes > 1) medium = fours[word + stride];
  if (planes > 2) high = fours[word + 2u * stride];
#if STRATA_CLASSES
  uint kind = page[batch.firstClass + (at >> 2)];
#else
  const uint kind = 0u;
#endif
  uint point = at - pointsBefore();  // wraps round to a huge number in front of the batch's first point
  return visitOne(uvec3(low.x, medium.x, high.x), point, kind, 0u) |
         visitOne(uvec3(low.y, medium.y, high.y), point + 1u, kind, 1u) |
         visitOne(uvec3(low.z, medium.z, high.z), point + 2u, kind, 2u) |
         visitOne(uvec3(low.w, medium.w, high.w), point + 3u, kind, 3u);
}

void visitAll() {
#if STRATA_PREFETCH
  uint end = batch.pointCount + pointsBefore();
  for (uint at = 4u * gl_LocalInvocationID.x; at < end; at += 4u * STRATA_GROUP_SIZE) visitFour(at);
#else
  for (uint point = gl_LocalInvocationID.x; point < batch.pointCount; point += STRATA_GROUP_SIZE) {
    uint word = batch.firstWord + point;
    uvec3 words = uvec3(page[word], 0u, 0u);
    if (planes > 1) words.y = page[word + batch.planeStride];
    if (planes > 2) words.z = page[word + 2u * batch.planeStride];
    visitOne(words, point, 0u, 0u);
  }
#endif
}
