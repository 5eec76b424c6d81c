// One round of the second step (4.2): each pixel looks at the layers of the eight pixels that are one jump away. It
// holds the closest seed of each of up to four layers; a fifth layer replaces the one whose seed is farthest.
layout(std430, binding = STRATA_BINDING_FLOOD_FROM) readonly buffer From { uvec4 from[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_TO) writeonly buffer To { uvec4 to[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_REACHES) readonly buffer Reaches { uint reaches[]; };

uvec4 held;

int distance2(uint seed) {
  ivec2 d = (pixelOf(seed) >> 1) - here();
  return d.x * d.x + d.y * d.y;
}

bool closer(int distance, uint seed, int otherDistance, uint other) {
  return distance < otherDistance || (distance == otherDistance && seed < other);
}

void consider(uint candidate) {
  if (any(equal(held, uvec4(candidate)))) return;
  FloodSeed seed = seeds[indexOf(candidate)];
  int distance = distance2(candidate);
  float reach = reachPx(seed) + 1.0;
  if (float(distance) > reach * reach) return;
  int farthest = 0;
  for (int k = 0; k < 4; ++k) {
    if (held[k] == kNone) {
      held[k] = candidate;
      return;
    }
    if (sameLayer(seeds[indexOf(held[k])], seed)) {
      if (closer(distance, candidate, distance2(held[k]), held[k])) held[k] = candidate;
      return;
    }
    if (!closer(distance2(held[k]), held[k], distance2(held[farthest]), held[farthest])) farthest = k;
  }
  if (closer(distance, candidate, distance2(held[farthest]), held[farthest])) held[farthest] = candidate;
}

void main() {
  ivec2 p = here();
  if (!inside(p)) return;
  held = from[indexAt(p)];
  ivec2 tile = p / STRATA_FLOOD_TILE;
  float nearby = uintBitsToFloat(reaches[(params.tileRows + tile.y) * params.tileColumns + tile.x]);
  if (jump == 1 || float(jump) <= nearby)
    for (int i = 0; i < 9; ++i) {
      ivec2 q = p + jump * ivec2(i % 3 - 1, i / 3 - 1);
      if (i == 4 || !inside(q)) continue;
      uvec4 there = from[indexAt(q)];
      for (int k = 0; k < 4 && there[k] != kNone; ++k) consider(there[k]);
    }
  to[indexAt(p)] = held;
}
