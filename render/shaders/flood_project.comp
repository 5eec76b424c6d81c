// The first step (4.1): finds the nearest point of each 2 x 2 pixels, and the largest reach in each tile.
layout(std430, binding = STRATA_BINDING_FLOOD_NORMALS) readonly buffer Normals { uint normals[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_TO) writeonly buffer Layers { uvec4 layers[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_REACHES) buffer Reaches { uint reaches[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_ITEMS) readonly buffer Items { FloodItem items[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_IDS) readonly buffer Ids { uint ids[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_DEPTHS) readonly buffer Depths { float depths[]; };

float reachOf(uint id) {
  uint first = 0u, end = params.items;
  while (end - first > 1u) {
    uint middle = (first + end) >> 1;
    if (items[middle].firstId <= id) first = middle;
    else end = middle;
  }
  return items[first].reach;
}

void main() {
  ivec2 p = here();
  if (!inside(p)) return;
  FloodSeed seed = FloodSeed(kNone, kInfinite, 0.0, 0u);
  uint id = kNone;
  for (int v = 2 * p.y; v < min(2 * p.y + 2, params.height); ++v)
    for (int u = 2 * p.x; u < min(2 * p.x + 2, params.width); ++u) {
      uint i = uint(v * params.width + u);
      if (ids[i] == kNone || (id != kNone && !(depths[i] < seed.depth))) continue;
      id = ids[i];
      seed.depth = depths[i];
      seed.pixel = uint(v) << 16 | uint(u);
    }
  uint index = indexAt(p);
  if (id != kNone) {
    seed.reach = reachOf(id);
    // Seeds in neighbouring pixels must reach each other, however fine the scan is.
    if (has(STRATA_FLOOD_SECTORS)) seed.reach = max(seed.reach, STRATA_FLOOD_NEXT_PIXELS * metres(seed.depth));
    if (has(STRATA_FLOOD_NORMALS)) seed.normal = normals[index];
    ivec2 tile = p / STRATA_FLOOD_TILE;
    float reach = min(reachPx(seed), params.farthestReach);
    if (reach > 0.0) atomicMax(reaches[tile.y * params.tileColumns + tile.x], floatBitsToUint(reach));
  }
  seeds[index] = seed;
  layers[index] = uvec4(seed.pixel, kNone, kNone, kNone);
}
