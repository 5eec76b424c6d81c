// Writes the sums of the splats into the picture. A thread writes two by two pixels of it.
layout(std430, binding = STRATA_BINDING_FLOOD_FROM) buffer Ids { uint ids[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_LIMITS) readonly buffer Limits { uint limits[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_COLOURS) writeonly buffer Colours { uint colours[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_SUMS) readonly buffer Sums { FloodSum sums[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_IDS) writeonly buffer Filled { uint filled[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_DEPTHS) writeonly buffer Depths { float depths[]; };

void main() {
  ivec2 p = here();
  if (!inside(p)) return;
  for (int y = 2 * p.y; y < min(2 * p.y + 2, params.height); ++y)
    for (int x = 2 * p.x; x < min(2 * p.x + 2, params.width); ++x) {
      uint i = uint(y * params.width + x);
      FloodSum sum = sums[i];
      filled[i] = ids[i];
      if (sum.weight == 0u) continue;
      float share = 1.0 / float(sum.weight);
      uvec3 mean = uvec3(vec3(sum.red, sum.green, sum.blue) * share + 0.5);
      colours[i] = mean.x | mean.y << 8 | mean.z << 16 | 0xff000000u;
      float limit = uintBitsToFloat(limits[i]);
      depths[i] = limit * (1.0 - float(sum.depth) * share / STRATA_FLOOD_DEPTHS);
      uint ones = (1u << params.indexBits) - 1u;
      ivec2 from = pixelOf(seeds[ones - (sum.heaviest & ones)].pixel);
      filled[i] = ids[from.y * params.width + from.x];
    }
}
