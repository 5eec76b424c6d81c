// Two passes over the batches find the smallest depth of each pixel, then the lowest id at that depth. One program does
// both, so that both compute the same bits. The first pass notes for each point, in a bit, whether it was at the front
// when it was drawn. The second visits only those, because a point that is at the front in the end was there then, too.
layout(std430, binding = STRATA_BINDING_DEPTH) buffer Depths { uint depths[]; };
layout(std430, binding = STRATA_BINDING_ID) buffer Ids { uint ids[]; };
layout(std430, binding = STRATA_BINDING_MORE) buffer Candidates { uint candidates[]; };

layout(location = STRATA_UNIFORM_PASS) uniform int indexPass;

const uint kFours = 8u;  // fours of points whose bits share a word

bool visit(uvec3 words, uint point) {
  bool front = false;
  for (int view = 0; view < STRATA_VIEWS; ++view) {
    uint depth;
    int pixel = pixelOf(view, words, depth);
    if (pixel < 0) continue;
    if (indexPass != 0) {
      uint id = batch.firstId + point;
      if (depth == depths[pixel] && id < ids[pixel]) atomicMin(ids[pixel], id);
    } else {
      uint old = depths[pixel];
      if (depth < old) atomicMin(depths[pixel], depth);
      front = front || depth <= old;
    }
  }
  return front;
}

void main() {
  beginBatch();
  uint thread = gl_LocalInvocationID.x;
  uint end = batch.pointCount + pointsBefore();
  uint threads = min((end + 3u) >> 2, uint(STRATA_GROUP_SIZE));  // threads that have a point
  for (uint first = 4u * thread, slot = batch.firstCandidate + thread; first < end;
       first += 4u * kFours * STRATA_GROUP_SIZE, slot += threads) {
    if (indexPass == 0) {
      uint bits = 0u;
      for (uint i = 0u; i < kFours; ++i) {
        uint at = first + 4u * STRATA_GROUP_SIZE * i;
        if (at < end) bits |= visitFour(at) << (4u * i);
      }
      candidates[slot] = bits;
    } else {
      for (uint bits = candidates[slot]; bits != 0u; bits &= bits - 1u) {
        uint bit = uint(findLSB(bits));
        uint point = first + 4u * STRATA_GROUP_SIZE * (bit >> 2) + (bit & 3u) - pointsBefore();
        uint word = batch.firstWord + point;
        uvec3 words = uvec3(page[word], 0u, 0u);
        if (planes > 1) words.y = page[word + batch.planeStride];
        if (planes > 2) words.z = page[word + 2u * batch.planeStride];
        visit(words, point);
      }
    }
  }
}
