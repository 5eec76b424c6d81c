// A lock for each pixel (Günther 2013, Algorithms 2 and 3): early-out, lock, depth test, write, unlock. The depth is
// the one in clip space (4.2.2). Their threads wait as long as it takes. Here a thread gives up after STRATA_LOCK_TURNS
// turns and counts that, and the host then finishes the picture with the passes of compute32.
layout(std430, binding = STRATA_BINDING_DEPTH) coherent volatile buffer Depths { uint depths[]; };
layout(std430, binding = STRATA_BINDING_ID) coherent volatile buffer Ids { uint ids[]; };
layout(std430, binding = STRATA_BINDING_MORE) coherent volatile buffer Locks { uint locks[]; };
layout(std430, binding = STRATA_BINDING_COUNTERS) buffer CountersOfFrame { Counters counters; };

uint retries = 0u;

void show(int pixel, uint depth, uint id) {
  bool done = false;
  for (uint turn = 0u; !done; ++turn) {
    if (depth > depths[pixel]) {  // early-out; an equal depth may still win by its id
      done = true;
    } else if (turn == STRATA_LOCK_TURNS) {
      atomicAdd(counters.lockGivenUp, 1u);
      done = true;
    } else if (atomicCompSwap(locks[pixel], 0u, 1u) == 0u) {
      memoryBarrierBuffer();
      uint front = depths[pixel];
      if (depth < front || (depth == front && id < ids[pixel])) {
        depths[pixel] = depth;
        ids[pixel] = id;
      }
      memoryBarrierBuffer();
      atomicExchange(locks[pixel], 0u);
      done = true;
    } else {
      ++retries;
    }
  }
}

bool visit(uvec3 words, uint point) {
  for (int view = 0; view < STRATA_VIEWS; ++view) {
    uint depth;
    int pixel = pixelOf(view, words, depth);
    if (pixel >= 0) show(pixel, depth, batch.firstId + point);
  }
  return false;
}

void main() {
  beginBatch();
  visitAll();
  if (retries > 0u) atomicAdd(counters.lockRetries, retries);
}
