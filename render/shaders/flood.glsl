// What all steps of hole filling by jump flooding share (Farias 2014). There is one thread per pixel of the half
// picture. The arithmetic is that of flood_search.cpp and flood_splats.cpp.
layout(local_size_x = STRATA_GROUP_SIZE) in;

layout(std430, binding = STRATA_BINDING_FLOOD_PARAMS) readonly buffer Params { FloodParams params; };
layout(std430, binding = STRATA_BINDING_FLOOD_SEEDS) buffer Seeds { FloodSeed seeds[]; };

layout(location = STRATA_UNIFORM_PASS) uniform int jump;  // pixels

const uint kNone = 0xffffffffu;
#define kInfinite uintBitsToFloat(0x7f800000u)

bool has(uint flag) { return (params.flags & flag) != 0u; }

ivec2 here() { return ivec2(gl_GlobalInvocationID.xy); }
bool inside(ivec2 p) { return p.x >= 0 && p.y >= 0 && p.x < params.halfWidth && p.y < params.halfHeight; }
uint indexAt(ivec2 p) { return uint(p.y * params.halfWidth + p.x); }

ivec2 pixelOf(uint seed) { return ivec2(seed & 0xffffu, seed >> 16); }
uint indexOf(uint seed) { return indexAt(pixelOf(seed) >> 1); }

float metres(float depth) { return params.perPixel * (has(STRATA_FLOOD_PERSPECTIVE) ? depth : 1.0); }

vec3 positionOf(FloodSeed seed) {
  vec2 pixel = vec2(pixelOf(seed.pixel)) + 0.5;
  return vec3((pixel.x - params.middleX) * metres(seed.depth), (params.middleY - pixel.y) * metres(seed.depth),
              seed.depth);
}

vec3 normalOf(FloodSeed seed) {
  if (seed.normal == 0u) return vec3(0.0);
  return (vec3(seed.normal & 1023u, seed.normal >> 10 & 1023u, seed.normal >> 20) - 512.0) / 511.0;
}

/// The largest distance of a neighbour, in pixels of the half picture.
float reachPx(FloodSeed seed) { return 0.5 * seed.reach / metres(seed.depth); }

bool sameLayer(FloodSeed a, FloodSeed b) {
  vec3 apart = positionOf(b) - positionOf(a);
  float reach = min(a.reach, b.reach);
  if (dot(apart, apart) > reach * reach) return false;
  if (a.normal == 0u || b.normal == 0u) return true;
  vec3 normalA = normalOf(a), normalB = normalOf(b);
  return abs(dot(normalA, normalB)) >= params.angle &&
         max(abs(dot(apart, normalA)), abs(dot(apart, normalB))) < params.continuity * reach;
}

int sectorOf(vec2 d) {
  return (d.y < 0.0 ? 4 : 0) | (d.x < 0.0 ? 2 : 0) | (abs(d.x) < abs(d.y) ? 1 : 0);
}
