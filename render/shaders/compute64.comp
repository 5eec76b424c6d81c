// Depth and id of a pixel share a 64-bit word, which one atomic minimum lowers (Schütz 2022, Listing 1).
layout(std430, binding = STRATA_BINDING_DEPTH) buffer Pixels { uint64_t pixels[]; };

bool visit(uvec3 words, uint point) {
  for (int view = 0; view < STRATA_VIEWS; ++view) {
    uint depth;
    int pixel = pixelOf(view, words, depth);
    if (pixel < 0) continue;
    uint64_t front = uint64_t(depth) << 32 | uint64_t(batch.firstId + point);
    if (front < pixels[pixel]) atomicMin(pixels[pixel], front);
  }
  return false;
}

void main() {
  beginBatch();
  visitAll();
}
