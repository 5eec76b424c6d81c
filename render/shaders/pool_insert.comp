// Puts new points at their shuffled places in the pool (Rumpler 2019, 3.3). There is one work-group per piece.
layout(local_size_x = STRATA_GROUP_SIZE) in;

layout(std430, binding = STRATA_BINDING_STAGED) readonly buffer Staged { uvec4 staged[]; };
layout(std430, binding = STRATA_BINDING_INSERTS) readonly buffer Inserts { PoolInsert inserts[]; };

void main() {
  PoolInsert insert = inserts[gl_WorkGroupID.x];
  for (uint i = gl_LocalInvocationID.x; i < insert.count; i += STRATA_GROUP_SIZE)
    putPoint(insert.first + i, staged[insert.staged + i]);
}
