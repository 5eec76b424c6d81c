flat in uint id;

#if STRATA_COUNT
layout(std430, binding = STRATA_BINDING_MORE) buffer Counts { uint counts[]; };
layout(location = STRATA_UNIFORM_PASS) uniform int width;

void main() { atomicAdd(counts[int(gl_FragCoord.y) * width + int(gl_FragCoord.x)], 1u); }
#else
layout(location = 0) out uint pixelId;

void main() { pixelId = id; }
#endif
