// One round of the third step (4.3): each seed looks at the layers one jump away and at the neighbours of the seeds
// there. With jump 0 it looks at its neighbours' neighbours. The neighbours of a seed take two uvec4.
layout(std430, binding = STRATA_BINDING_FLOOD_FROM) readonly buffer From { uvec4 from[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_TO) writeonly buffer To { uvec4 to[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_LAYERS) readonly buffer Layers { uvec4 layers[]; };

const int kClosest = 4;

FloodSeed self;
uint found[8];
float distances[8];

float distance2(FloodSeed other) {
  vec3 apart = positionOf(other) - positionOf(self);
  return dot(apart, apart);
}

bool before(float distance, uint candidate, int place) {
  return distance < distances[place] || (distance == distances[place] && candidate < found[place]);
}

void consider(uint candidate) {
  if (candidate == kNone || candidate == self.pixel) return;
  bool sectors = has(STRATA_FLOOD_SECTORS);
  int place = sectors ? sectorOf(vec2(pixelOf(candidate) - pixelOf(self.pixel))) : kClosest - 1;
  if (found[place] == candidate) return;
  FloodSeed other = seeds[indexOf(candidate)];
  float distance = distance2(other);
  if (!before(distance, candidate, place) || !sameLayer(self, other)) return;
  if (!sectors) {
    for (place = 0; place < kClosest && !before(distance, candidate, place); ++place)
      if (found[place] == candidate) return;
    for (int i = kClosest - 1; i > place; --i) {
      found[i] = found[i - 1];
      distances[i] = distances[i - 1];
    }
  }
  found[place] = candidate;
  distances[place] = distance;
}

void considerNeighboursOf(uint index) {
  for (int half_ = 0; half_ < 2; ++half_) {
    uvec4 some = from[2u * index + uint(half_)];
    for (int k = 0; k < 4; ++k) consider(some[k]);
  }
}

void main() {
  ivec2 p = here();
  if (!inside(p)) return;
  uint index = indexAt(p);
  self = seeds[index];
  if (self.pixel == kNone) return;
  for (int i = 0; i < 8; ++i) {
    found[i] = from[2u * index + uint(i / 4)][i % 4];
    distances[i] = found[i] == kNone ? kInfinite : distance2(seeds[indexOf(found[i])]);
  }
  if (jump == 0) {
    for (int i = 0; i < 8; ++i) {
      uint neighbour = from[2u * index + uint(i / 4)][i % 4];
      if (neighbour != kNone) considerNeighboursOf(indexOf(neighbour));
    }
  } else if (float(jump) <= reachPx(self)) {
    for (int i = 0; i < 9; ++i) {
      ivec2 q = p + jump * ivec2(i % 3 - 1, i / 3 - 1);
      if (i == 4 || !inside(q)) continue;
      uvec4 there = layers[indexAt(q)];
      for (int k = 0; k < 4 && there[k] != kNone; ++k) consider(there[k]);
      if (seeds[indexAt(q)].pixel != kNone) considerNeighboursOf(indexAt(q));
    }
  }
  to[2u * index] = uvec4(found[0], found[1], found[2], found[3]);
  to[2u * index + 1u] = uvec4(found[4], found[5], found[6], found[7]);
}
