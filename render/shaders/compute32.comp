// Two passes over all batches: the smallest depth of each pixel, then the lowest id at that depth. One program for
// both, so that both compute the same bits. One work-group draws one batch (Schütz 2022, 3.2).
layout(local_size_x = STRATA_GROUP_SIZE) in;

layout(std430, binding = STRATA_BINDING_DEPTH) buffer Depths { uint depths[]; };
layout(std430, binding = STRATA_BINDING_ID) buffer Ids { uint ids[]; };

layout(location = STRATA_UNIFORM_FIRST_RECORD) uniform uint firstRecord;
layout(location = STRATA_UNIFORM_INDEX_PASS) uniform int indexPass;
layout(location = STRATA_UNIFORM_ROWS) uniform ivec2 rows;

void main() {
  uint record = firstRecord + gl_WorkGroupID.x;
  vec4 rowX = records[record].x;
  vec4 rowY = records[record].y;
  vec4 rowDepth = records[record].depth;
  ivec4 offset = records[record].offset;
  ivec3 shift = records[record].shift.xyz;
  uint firstWord = records[record].firstWord;
  uint planeStride = records[record].planeStride;
  uint pointCount = records[record].pointCount;
  uint firstId = records[record].firstId;
  for (uint point = gl_LocalInvocationID.x; point < pointCount; point += STRATA_GROUP_SIZE) {
    uvec3 cell = pointCell(firstWord, planeStride, offset.w, point);
    vec3 place = project(rowX, rowY, rowDepth, gridSteps(cell, offset.xyz, shift));
    if (!inImage(place)) continue;
    int row = int(place.y);
    if (row < rows.x || row >= rows.y) continue;
    int pixel = (row - rows.x) * int(viewport.z) + int(place.x);
    uint depth = floatBitsToUint(place.z);
    if (indexPass == 0) {
      if (depth < depths[pixel]) atomicMin(depths[pixel], depth);
    } else if (depth == depths[pixel]) {
      atomicMin(ids[pixel], firstId + point);
    }
  }
}
