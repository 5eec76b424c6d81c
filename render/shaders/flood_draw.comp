// The second half of the fourth step: draws the depths of the splats (pass 0), then blends those in front (pass 1) by
// the weight exp(-d^2). All sums are of integers, so their order does not matter.
layout(std430, binding = STRATA_BINDING_FLOOD_FROM) readonly buffer Shapes { FloodShape shapes[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_LIMITS) buffer Limits { uint limits[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_SUMS) buffer Sums { FloodSum sums[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_DEPTHS) readonly buffer Depths { float depths[]; };

void main() {
  ivec2 p = here();
  if (!inside(p)) return;
  uint index = indexAt(p);
  FloodShape shape = shapes[index];
  if (shape.radius == 0.0) return;
  for (uint y = shape.rows & 0xffffu; y <= shape.rows >> 16; ++y)
    for (uint x = shape.columns & 0xffffu; x <= shape.columns >> 16; ++x) {
      vec2 d = vec2(float(x) + 0.5 - shape.x, float(y) + 0.5 - shape.y);
      float n = 1.0 + shape.tiltX * d.x + shape.tiltY * d.y;
      float a = (shape.acrossX * d.x + shape.acrossY * d.y) / n, b = (shape.alongX * d.x + shape.alongY * d.y) / n;
      float distance2 = a * a + b * b;
      if (!(distance2 <= 1.0) || !(n > 0.0)) continue;
      if ((shape.open >> sectorOf(d) & 1u) != 0u) distance2 *= STRATA_FLOOD_OPEN_SIDE * STRATA_FLOOD_OPEN_SIDE;
      if (distance2 > 1.0) continue;
      float depth = (shape.centreDepth + shape.slopeX * d.x + shape.slopeY * d.y) / n;
      uint i = y * uint(params.width) + x;
      if (jump == 0) {
        atomicMin(limits[i], floatBitsToUint(depth + max(depth * STRATA_FLOOD_DEPTH_SHARE, shape.radius)));
        continue;
      }
      float limit = uintBitsToFloat(limits[i]);
      if (depth > limit || (has(STRATA_FLOOD_KEEP_FRONT) && depths[i] <= limit)) continue;
      uint weight = uint(STRATA_FLOOD_WEIGHT * exp(-distance2) + 0.5);
      atomicAdd(sums[i].red, weight * (shape.colour & 255u));
      atomicAdd(sums[i].green, weight * (shape.colour >> 8 & 255u));
      atomicAdd(sums[i].blue, weight * (shape.colour >> 16 & 255u));
      atomicAdd(sums[i].weight, weight);
      atomicAdd(sums[i].depth, weight * uint(STRATA_FLOOD_DEPTHS * (limit - depth) / limit + 0.5));
      uint ones = (1u << params.indexBits) - 1u;
      atomicMax(sums[i].heaviest, (weight << params.indexBits) | (ones - index));
    }
}
