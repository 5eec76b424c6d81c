// Finds for each tile the largest reach of all tiles that reach into it. These follow the tiles' own reaches in the
// buffer. There is one thread per tile.
layout(std430, binding = STRATA_BINDING_FLOOD_REACHES) buffer Reaches { uint reaches[]; };

void main() {
  ivec2 p = here();
  if (p.x >= params.tileColumns || p.y >= params.tileRows) return;
  int most = int(params.farthestReach) / STRATA_FLOOD_TILE + 1;
  float nearby = 0.0;
  for (int v = max(p.y - most, 0); v <= min(p.y + most, params.tileRows - 1); ++v)
    for (int u = max(p.x - most, 0); u <= min(p.x + most, params.tileColumns - 1); ++u) {
      float reach = uintBitsToFloat(reaches[v * params.tileColumns + u]);
      int tiles = int(reach) / STRATA_FLOOD_TILE + 1;
      if (reach > 0.0 && max(abs(u - p.x), abs(v - p.y)) <= tiles) nearby = max(nearby, reach);
    }
  reaches[(params.tileRows + p.y) * params.tileColumns + p.x] = floatBitsToUint(nearby);
}
