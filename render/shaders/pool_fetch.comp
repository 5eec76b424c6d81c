// Fetches the points of pixels anew where their pieces were written again, because these have more bits now.
layout(local_size_x = STRATA_GROUP_SIZE) in;

layout(std430, binding = STRATA_BINDING_STAGED) buffer Kept { uvec4 kept[]; };
layout(std430, binding = STRATA_BINDING_INSERTS) readonly buffer Pieces { PoolPiece pieces[]; };

layout(location = STRATA_UNIFORM_RANGE) uniform uvec3 range;

void main() {
  uint threads = gl_NumWorkGroups.x * STRATA_GROUP_SIZE;
  for (uint pixel = gl_GlobalInvocationID.x; pixel < range.y; pixel += threads) {
    uint word = kept[pixel].w;
    if (word == STRATA_NO_POINT) continue;
    PoolPiece piece = pieces[word >> STRATA_PIECE_BITS & ((1u << STRATA_SLOT_BITS) - 1u)];
    if ((piece.flags & STRATA_PIECE_WRITTEN) != 0u)
      kept[pixel] = pointAt(piece.first + (word & ((1u << STRATA_PIECE_BITS) - 1u)));
  }
}
