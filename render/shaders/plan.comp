// planBatches() of batch_plan.cpp on the GPU. One work-group takes the batches of one part, culls them, chooses their
// precision, and appends those that are left to the records of its run. It computes in doubles, so that it decides as
// the CPU does.
layout(local_size_x = STRATA_PLAN_SIZE) in;

layout(std430, binding = STRATA_BINDING_PAGE) readonly buffer Page { uint page[]; };
layout(std430, binding = STRATA_BINDING_RECORDS) writeonly buffer Records { BatchRecord records[]; };
layout(std430, binding = STRATA_BINDING_BATCH_VIEWS) writeonly buffer BatchViews { BatchView batchViews[]; };
layout(std430, binding = STRATA_BINDING_PARTS) readonly buffer Parts { DrawPart parts[]; };
layout(std430, binding = STRATA_BINDING_VIEWS) readonly buffer Views { ViewRecord views[]; };
layout(std430, binding = STRATA_BINDING_RUNS) buffer Runs { DispatchRecord runs[]; };
layout(std430, binding = STRATA_BINDING_COUNTERS) buffer CountersOfFrame { Counters counters; };

layout(location = STRATA_UNIFORM_FIRST_PART) uniform uint firstPart;
layout(location = STRATA_UNIFORM_CLIPS) uniform ivec3 clips;
layout(location = STRATA_UNIFORM_FORCED) uniform int forcedPlanes;

const int kOutside = 0, kPartly = 1, kInside = 2;

double doubleAt(uint word) { return packDouble2x32(uvec2(page[word], page[word + 1u])); }

int sideOf(dvec4 plane, dvec3 lo, dvec3 hi) {
  dvec3 a = plane.xyz * lo, b = plane.xyz * hi;
  dvec3 least = min(a, b), most = max(a, b);
  if (plane.w + most.x + most.y + most.z < 0.0LF) return kOutside;
  return plane.w + least.x + least.y + least.z >= 0.0LF ? kInside : kPartly;
}

int sideOfBox(int view, int i, dvec3 lo, dvec3 hi) {
  dvec3 boxLo = views[view].clipLo[i].xyz, boxHi = views[view].clipHi[i].xyz;
  if (all(greaterThanEqual(lo, boxLo)) && all(lessThanEqual(hi, boxHi))) return kInside;
  return any(lessThan(hi, boxLo)) || any(greaterThan(lo, boxHi)) ? kOutside : kPartly;
}

int clipSide(int view, dvec3 lo, dvec3 hi) {
  int side = clips.x == 0 ? kInside : kOutside;
  for (int i = 0; i < clips.x; ++i) side = max(side, sideOfBox(view, i, lo, hi));
  for (int i = clips.x; i < clips.x + clips.z; ++i) side = min(side, kInside + kOutside - sideOfBox(view, i, lo, hi));
  for (int i = 0; i < clips.y; ++i) side = min(side, sideOf(views[view].clipPlanes[i], lo, hi));
  return side;
}

/// The planes that batchPrecision() wants by the size of the batch: projectedSizePx() against its thresholds.
int wantedPlanes(int view, dvec3 lo, dvec3 size) {
  dvec4 forward = views[view].forward, measure = views[view].size;
  double longest = max(max(size.x, size.y), size.z);
  double pixels = longest * measure.x;
  if (measure.w != 0.0LF) {
    double nearest = 0.0LF;
    for (int axis = 0; axis < 3; ++axis)
      nearest += forward[axis] * (forward[axis] >= 0.0LF ? lo[axis] : lo[axis] + size[axis]);
    pixels = longest * measure.x * measure.y / max(max(nearest, measure.z), 1e-9LF);
  }
  return pixels < STRATA_PX_AT_10_BITS ? 1 : pixels < STRATA_PX_AT_20_BITS ? 2 : 3;
}

/// How a view sees a batch; offset.w is 0 where it does not see it.
BatchView batchViewOf(int view, DrawPart part, uint box, dvec3 boxMin) {
  BatchView batchView = BatchView(ivec4(0), ivec4(0));
  ivec4 first = part.first[view];
  if (first.w < 0) return batchView;
  ivec3 bits = ivec3(uvec3(page[box + 9u], page[box + 9u] >> 8, page[box + 9u] >> 16) & 255u);
  dvec3 size;
  for (int axis = 0; axis < 3; ++axis) size[axis] = ldexp(part.step[axis], bits[axis]);
  dvec3 lo = (part.origin.xyz - views[view].eye.xyz) + boxMin, hi = lo + size;
  int side = clipSide(view, lo, hi);
  int mostBits = max(max(bits.x, bits.y), bits.z);
  int planes = min(min(wantedPlanes(view, lo, size), mostBits <= 10 ? 1 : mostBits <= 20 ? 2 : 3), int(part.planes));
  if (forcedPlanes != 0) {
    planes = min(forcedPlanes, int(part.planes));
  } else {
    if (side == kOutside) return batchView;
    for (int i = 0; i < 5; ++i)
      if (sideOf(views[view].planes[i], lo, hi) == kOutside) return batchView;
  }
  ivec3 shift = bits - 10 * planes;
  ivec3 middle = ivec3(0);
  for (int axis = 0; axis < 3; ++axis)
    if (shift[axis] > 0) middle[axis] = 1 << (shift[axis] - 1);
  ivec3 steps = ivec3(int(page[box + 6u]), int(page[box + 7u]), int(page[box + 8u]));
  batchView.offset = ivec4(first.xyz + steps + middle, planes);
  batchView.shift = ivec4(shift, 2 * first.w + (side == kPartly ? STRATA_CLIPPED : 0));
  return batchView;
}

void main() {
  DrawPart part = parts[firstPart + gl_WorkGroupID.x];
  for (uint i = gl_LocalInvocationID.x; i < part.boxCount; i += STRATA_PLAN_SIZE) {
    uint box = part.firstBox + i * STRATA_BOX_WORDS;
    uint firstPoint = page[box + 10u];
    if (firstPoint >= part.prefix) continue;
    dvec3 boxMin = dvec3(doubleAt(box), doubleAt(box + 2u), doubleAt(box + 4u));
    BatchView seen[STRATA_VIEWS];
    int sightings = 0;
    for (int view = 0; view < STRATA_VIEWS; ++view) {
      seen[view] = batchViewOf(view, part, box, boxMin);
      if (seen[view].offset.w == 0) {
        atomicAdd(counters.batchesCulled, 1u);
        continue;
      }
      ++sightings;
      atomicAdd(counters.batchesAt[seen[view].offset.w - 1], 1u);
    }
    if (sightings == 0) continue;
    BatchRecord record;
    uint ahead = firstPoint - part.firstPoint;
    record.firstWord = part.firstWord + ahead;
    record.planeStride = part.planeStride;
    record.pointCount = min(page[box + 11u], part.prefix - firstPoint);
    record.firstId = part.firstId + firstPoint;
    record.firstClass = part.firstClass == 0u ? 0u : part.firstClass + (ahead >> 2);
    record.firstColour = part.firstColour == 0u ? 0u : part.firstColour + ahead;
    record.firstCandidate = part.firstCandidate + page[box + 12u];
    record.padding = 0u;
    atomicAdd(counters.batchesDrawn, uint(sightings));
    atomicAdd(counters.pointsDrawn, uint(sightings) * record.pointCount);
    uint index = part.firstRecord + atomicAdd(runs[part.run].x, 1u);
    records[index] = record;
    for (int view = 0; view < STRATA_VIEWS; ++view) batchViews[index * STRATA_VIEWS + view] = seen[view];
  }
}
