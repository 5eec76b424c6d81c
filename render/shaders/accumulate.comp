// High-quality shading (Schütz, Kerbl, Wimmer 2021): once the front depths are known, sums the colours of the points
// that lie at most a hundredth behind the front. With STRATA_COUNT it counts all points of a pixel instead (overdraw).
layout(std430, binding = STRATA_BINDING_DEPTH) readonly buffer Depths { uint depths[]; };
layout(std430, binding = STRATA_BINDING_MORE) buffer Sums { uint sums[]; };

layout(location = STRATA_UNIFORM_PRECISIONS) uniform uvec3 precisions;

const float kBlendDepth = 1.01;      // DrawOptions::kBlendDepth
const uint kMostPoints = 0xffff00u;  // points of a pixel whose sum fits 32 bits, with room for threads that race

bool visit(uvec3 words, uint point) {
  for (int view = 0; view < STRATA_VIEWS; ++view) {
    uint depth;
    int pixel = pixelOf(view, words, depth);
    if (pixel < 0) continue;
#if STRATA_COUNT
    atomicAdd(sums[pixel], 1u);
#else
    float front = uintBitsToFloat(depths[pixel * STRATA_DEPTH_STRIDE + STRATA_DEPTH_STRIDE - 1]);
    if (uintBitsToFloat(depth) > front * kBlendDepth || sums[4 * pixel + 3] >= kMostPoints) continue;
    uint colour = precisions.x == 0u ? page[batch.firstColour + point] : precisions[seen[view].planes - 1];
    atomicAdd(sums[4 * pixel], colour & 255u);
    atomicAdd(sums[4 * pixel + 1], colour >> 8 & 255u);
    atomicAdd(sums[4 * pixel + 2], colour >> 16 & 255u);
    atomicAdd(sums[4 * pixel + 3], 1u);
#endif
  }
  return false;
}

void main() {
  beginBatch();
  visitAll();
}
