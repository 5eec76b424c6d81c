// One GL point for each point. The position is set to the middle of its pixel, so that every driver fills the pixel
// that the other rasterizers fill. The depth goes to a float buffer scaled by a power of two, which keeps all its bits.
layout(location = STRATA_ATTRIBUTE_RECORD) in uint record;

flat out uint id;

const float kDepthScale = 1.0 / 1099511627776.0;  // 2^-40: depths up to 1e12 m

void main() {
  uint point = uint(gl_VertexID);
  uvec3 cell = pointCell(records[record].firstWord, records[record].planeStride, records[record].offset.w, point);
  vec3 d = gridSteps(cell, records[record].offset.xyz, records[record].shift.xyz);
  vec3 place = project(records[record].x, records[record].y, records[record].depth, d);
  id = records[record].firstId + point;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // outside
  if (inImage(place)) gl_Position = vec4((floor(place.xy) + 0.5) / viewport.xy - 1.0, place.z * kDepthScale, 1.0);
}
