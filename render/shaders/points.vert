// Draws one GL point per point. Its position is the middle of its pixel, so that every driver fills the pixel that the
// other rasterizers fill. The depth buffer holds floats, and the depth is scaled by a power of two, which keeps its
// bits.
layout(location = STRATA_ATTRIBUTE_RECORD) in uint record;

flat out uint id;

const float kDepthScale = 1.0 / 1099511627776.0;  // 2^-40: depths up to 1e12 m

bool kept(BatchRecord batch, Seen seen, uint point, vec3 d) {
#if STRATA_CLASSES
  uint at = (batch.firstWord & 3u) + point;
  if (batch.firstClass != 0u && !keptByClass(page[batch.firstClass + (at >> 2)], at & 3u)) return false;
#endif
#if STRATA_CLIP
  if (seen.grid >= 0 && !keptByClip(seen.grid, d)) return false;
#endif
  return true;
}

void main() {
  uint point = uint(gl_VertexID);
  BatchRecord batch = records[record];
  Seen seen = seenBy(record, 0);
  uint word = batch.firstWord + point;
  uvec3 words = uvec3(page[word], 0u, 0u);
  if (seen.planes > 1) words.y = page[word + batch.planeStride];
  if (seen.planes > 2) words.z = page[word + 2u * batch.planeStride];
  vec3 d = gridSteps(seen, words);
  vec3 projected = project(seen, 0, d);
  id = batch.firstId + point;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // outside of the image
  if (inImage(0, projected) && kept(batch, seen, point, d))
    gl_Position = vec4((floor(projected.xy) - lenses[0].zw + 0.5) / (0.5 * viewports[0].zw) - 1.0,
                       projected.z * kDepthScale, 1.0);
}
