// The passes of progressive drawing over some points: those that the pixels kept (reprojection; Rumpler 2019, 3.5.1) or
// a range of the pool (fill; 3.5.2). Three passes find the smallest depth of each pixel, find the lowest id at that
// depth, and keep the point that has both. A bit for each point says whether it may still be that one, as in
// compute32.comp.
layout(local_size_x = STRATA_GROUP_SIZE) in;

layout(std430, binding = STRATA_BINDING_POINTS) buffer Points { uvec4 points[]; };
layout(std430, binding = STRATA_BINDING_PIECES) readonly buffer Pieces { PoolPiece pieces[]; };
layout(std430, binding = STRATA_BINDING_KEPT) writeonly buffer Kept { uvec4 kept[]; };
layout(std430, binding = STRATA_BINDING_DEPTH) buffer Depths { uint depths[]; };
layout(std430, binding = STRATA_BINDING_ID) buffer Ids { uint ids[]; };
layout(std430, binding = STRATA_BINDING_MORE) buffer Candidates { uint candidates[]; };

layout(location = STRATA_UNIFORM_RANGE) uniform uvec3 range;
#if STRATA_ONE_GRID
layout(location = STRATA_UNIFORM_GRID) uniform vec4 gridRows[3];  // a single store has one grid, and loads are dear
#endif

const int pass = STRATA_PASS, kDepth = 0, kIndex = 1, kKeep = 2;
const uint kPoints = 32u;  // points of a thread, whose bits share a word

Seen seenBy(PoolPiece piece) {
  uint grid = piece.flags >> STRATA_PIECE_GRID;
  ivec3 shift = ivec3(uvec3(piece.shifts, piece.shifts >> 8, piece.shifts >> 16) & 255u) - 128;
  Seen seen;
#if STRATA_ONE_GRID
  seen.x = gridRows[0];
  seen.y = gridRows[1];
  seen.depth = gridRows[2];
#else
  seen.x = grids[grid].x;
  seen.y = grids[grid].y;
  seen.depth = grids[grid].depth;
#endif
  seen.offset = piece.offset.xyz;
  seen.left = uvec3(max(shift, ivec3(0)));
  seen.right = uvec3(max(-shift, ivec3(0)));
  seen.planes = int(piece.flags & STRATA_PIECE_PLANES);
  seen.grid = (piece.flags & STRATA_PIECE_CLIPPED) != 0u ? int(grid) : -1;
  return seen;
}

/// Returns the index of the pixel that point i of the range falls on, the bits of its depth, and its id; -1 where it is
/// not drawn. Removes points of freed pieces on the way.
int locate(uint i, uvec4 point, out uint depth, out uint id) {
  depth = 0u;
  id = 0u;
  if (point.w == STRATA_NO_POINT) return -1;
  PoolPiece piece = pieces[point.w >> STRATA_PIECE_BITS & ((1u << STRATA_SLOT_BITS) - 1u)];
  uint index = point.w & ((1u << STRATA_PIECE_BITS) - 1u);
  if (index >= piece.count) {
    if ((piece.flags & STRATA_PIECE_DEAD) != 0u) points[i].w = STRATA_NO_POINT;
    return -1;
  }
#if STRATA_CLASSES
  uvec4 bits = point >> 30u;
  uint kind = bits.x | bits.y << 2 | bits.z << 4 | bits.w << 6;
  if ((piece.flags & STRATA_PIECE_CLASSES) != 0u && !keptByClass(kind, 0u)) return -1;
#endif
  Seen seen = seenBy(piece);
  vec3 d = gridSteps(seen, point.xyz);
  vec3 projected = project(seen, 0, d);
  if (!inImage(0, projected)) return -1;
#if STRATA_CLIP
  if (seen.grid >= 0 && !keptByClip(seen.grid, d)) return -1;
#endif
  depth = floatBitsToUint(projected.z);
  id = uint(piece.offset.w) + index;
  ivec2 pixel = ivec2(projected.xy) - ivec2(lenses[0].zw);
  return pixel.y * int(viewports[0].z) + pixel.x;
}

/// True where the point may be the one that its pixel shows.
bool visit(uint i) {
  uvec4 point = points[i];
  uint depth, id;
  int pixel = locate(i, point, depth, id);
  if (pixel < 0) return false;
  if (pass == kDepth) {
    uint old = depths[pixel];
    if (depth < old) atomicMin(depths[pixel], depth);
    return depth <= old;
  }
  if (depth != depths[pixel]) return false;
  if (pass == kIndex) {
    if (id < ids[pixel]) atomicMin(ids[pixel], id);
  } else if (id == ids[pixel]) {
    kept[pixel] = point;
  }
  return true;
}

void main() {
  uint first = range.x + gl_WorkGroupID.x * kPoints * STRATA_GROUP_SIZE + gl_LocalInvocationID.x;
  uint word = range.z + gl_GlobalInvocationID.x;
  uint bits = 0u;
  if (pass == kDepth) {
    for (uint k = 0u; k < kPoints; ++k) {
      uint i = first + k * STRATA_GROUP_SIZE;
      if (i < range.y && visit(i)) bits |= 1u << k;
    }
  } else {
    for (uint left = candidates[word]; left != 0u; left &= left - 1u) {
      uint k = uint(findLSB(left));
      if (visit(first + k * STRATA_GROUP_SIZE)) bits |= 1u << k;
    }
  }
  if (pass != kKeep) candidates[word] = bits;
}
