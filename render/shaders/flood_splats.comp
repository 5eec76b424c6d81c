// The first half of the fourth step (4.4) shapes the splat of each seed. The functions are those of flood_splats.cpp.
layout(std430, binding = STRATA_BINDING_FLOOD_FROM) readonly buffer From { uvec4 from[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_TO) writeonly buffer Shapes { FloodShape shapes[]; };
layout(std430, binding = STRATA_BINDING_FLOOD_COLOURS) readonly buffer Colours { uint colours[]; };

vec3 offsets[8];
float distances[8];  // rising
int count = 0;
uint open = 0u;

void lookAround(uint index, vec3 position) {
  for (int i = 0; i < 8; ++i) {
    uint neighbour = from[2u * index + uint(i / 4)][i % 4];
    if (neighbour == kNone) {
      if (has(STRATA_FLOOD_SECTORS)) open |= 1u << i;
      continue;
    }
    vec3 offset = positionOf(seeds[indexOf(neighbour)]) - position;
    float distance = length(offset);
    int place = count++;
    offsets[place] = offset;
    for (; place > 0 && distances[place - 1] > distance; --place) distances[place] = distances[place - 1];
    distances[place] = distance;
  }
}

vec3 kernelOf(mat3 m) {
  vec3 products[3] = vec3[3](cross(m[0], m[1]), cross(m[0], m[2]), cross(m[1], m[2]));
  vec3 longest = vec3(0.0);
  float length2 = 0.0;
  for (int i = 0; i < 3; ++i)
    if (dot(products[i], products[i]) > length2) {
      longest = products[i];
      length2 = dot(longest, longest);
    }
  return length2 > 1e-20 ? longest / sqrt(length2) : vec3(0.0);
}

vec3 eigenvalues(mat3 m) {
  vec3 diagonal = vec3(m[0][0], m[1][1], m[2][2]) - 1.0 / 3.0;
  float beside = m[0][1] * m[0][1] + m[0][2] * m[0][2] + m[1][2] * m[1][2];
  float spread = sqrt((dot(diagonal, diagonal) + 2.0 * beside) / 6.0);
  if (spread < 1e-6) return vec3(1.0 / 3.0);
  float angle = acos(clamp(0.5 * determinant((m - mat3(1.0 / 3.0)) / spread), -1.0, 1.0)) / 3.0;
  float first = 1.0 / 3.0 + 2.0 * spread * cos(angle);
  float third = 1.0 / 3.0 + 2.0 * spread * cos(angle + 2.0943951);
  return vec3(first, 1.0 - first - third, third);
}

vec3 planeNormal(vec3 toEye) {
  mat3 moments = mat3(0.0);
  for (int i = 0; i < count; ++i) moments += outerProduct(offsets[i], offsets[i]);
  float size = moments[0][0] + moments[1][1] + moments[2][2];
  if (count < 2 || !(size > 0.0)) return toEye;
  moments /= size;
  vec3 values = eigenvalues(moments);
  if (values.y > STRATA_FLOOD_FLAT * values.x) {
    vec3 normal = kernelOf(moments - mat3(values.z));
    if (normal == vec3(0.0)) return toEye;
    return dot(normal, toEye) < 0.0 ? -normal : normal;
  }
  vec3 line = kernelOf(moments - mat3(values.x));
  vec3 facing = toEye - line * dot(line, toEye);
  return length(facing) > 0.1 ? normalize(facing) : toEye;
}

/// Sets across and along to the axes of the splat, divided by the squares of their lengths. Returns the longer radius,
/// metres.
float axesOf(vec3 normal, float radius, out vec3 across, out vec3 along) {
  vec3 other = abs(normal.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
  vec3 u = normalize(cross(normal, other)), v = cross(normal, u);
  float stretch = 1.0;
  vec3 longer = u;
  if (has(STRATA_FLOOD_ELLIPSES)) {
    float uu = 0.0, uv = 0.0, vv = 0.0;
    for (int i = 0; i < count; ++i) {
      float a = dot(offsets[i], u), b = dot(offsets[i], v);
      uu += a * a;
      uv += a * b;
      vv += b * b;
    }
    float middle = 0.5 * (uu + vv), lean = 0.5 * (uu - vv), spread = sqrt(lean * lean + uv * uv);
    float least = (middle + spread) / (STRATA_FLOOD_MOST_STRETCH * STRATA_FLOOD_MOST_STRETCH);
    float ratio = (middle + spread) / max(middle - spread, max(least, 1e-30));
    if (ratio > STRATA_FLOOD_ROUND * STRATA_FLOOD_ROUND) {
      stretch = sqrt(sqrt(ratio));
      float cosine = lean / spread, sine = sqrt(max(0.5 - 0.5 * cosine, 0.0));
      longer = sqrt(max(0.5 + 0.5 * cosine, 0.0)) * u + (uv < 0.0 ? -sine : sine) * v;
    }
  }
  across = longer / (radius * stretch);
  along = cross(normal, longer) * (stretch / radius);
  return radius * stretch;
}

/// Expresses where the plane of the splat meets the ray of a pixel as a function of the pixel.
void project(vec3 centre, vec3 normal, vec3 across, vec3 along, inout FloodShape shape) {
  vec2 perPixel = vec2(params.perPixel, -params.perPixel), tilt = vec2(0.0), slope = vec2(0.0), a, b;
  if (has(STRATA_FLOOD_PERSPECTIVE)) {
    float ahead = dot(normal, centre);
    tilt = normal.xy * (centre.z / ahead);
    a = centre.z * (across.xy - normal.xy * (dot(across, centre) / ahead));
    b = centre.z * (along.xy - normal.xy * (dot(along, centre) / ahead));
  } else {
    slope = -normal.xy / normal.z;
    a = across.xy - normal.xy * (across.z / normal.z);
    b = along.xy - normal.xy * (along.z / normal.z);
  }
  shape.centreDepth = centre.z;
  shape.tiltX = tilt.x * perPixel.x;
  shape.tiltY = tilt.y * perPixel.y;
  shape.slopeX = slope.x * perPixel.x;
  shape.slopeY = slope.y * perPixel.y;
  shape.acrossX = a.x * perPixel.x;
  shape.acrossY = a.y * perPixel.y;
  shape.alongX = b.x * perPixel.x;
  shape.alongY = b.y * perPixel.y;
}

bool bound(vec3 centre, vec3 normal, inout FloodShape shape) {
  vec3 reach = shape.radius * sqrt(max(1.0 - normal * normal, 0.0));
  float nearest = max(centre.z - reach.z, 0.2 * centre.z);
  vec2 lo = vec2(kInfinite), hi = vec2(-kInfinite);
  for (int i = 0; i < 4; ++i) {
    float scale = 1.0 / metres(i < 2 ? nearest : centre.z + reach.z), side = i % 2 == 0 ? -1.0 : 1.0;
    vec2 pixel = vec2(params.middleX + (centre.x + side * reach.x) * scale,
                      params.middleY - (centre.y - side * reach.y) * scale);
    lo = min(lo, pixel);
    hi = max(hi, pixel);
  }
  ivec2 size = ivec2(params.width, params.height);
  ivec2 first = ivec2(clamp(lo, vec2(0.0), vec2(size)));
  ivec2 last = ivec2(clamp(floor(hi), vec2(-1.0), vec2(size - 1)));
  if (any(lessThan(last, first))) return false;
  shape.columns = uint(first.x) | uint(last.x) << 16;
  shape.rows = uint(first.y) | uint(last.y) << 16;
  return true;
}

bool make(uint index, FloodSeed seed, inout FloodShape shape) {
  vec3 position = positionOf(seed);
  lookAround(index, position);
  if (count == 0 || (has(STRATA_FLOOD_SECTORS) && count < STRATA_FLOOD_FEWEST)) return false;
  float median = 0.5 * (distances[(count - 1) / 2] + distances[count / 2]), pixel = metres(seed.depth);
  float radius = median, closest = distances[0];
  if (has(STRATA_FLOOD_SECTORS)) closest = max(closest, STRATA_FLOOD_SEED_PIXELS * pixel);
  if (has(STRATA_FLOOD_SECTORS) && median < STRATA_FLOOD_NEXT_PIXELS * pixel)
    radius = min(radius, params.mostReaches * seed.reach);
  if (!(radius > 0.0) || median > seed.reach || median > params.relativeRadius * closest) return false;
  if (radius < STRATA_FLOOD_LEAST_PIXELS * pixel) return false;
  vec3 toEye = has(STRATA_FLOOD_PERSPECTIVE) ? -normalize(position) : vec3(0.0, 0.0, -1.0);
  vec3 normal = normalOf(seed);
  if (seed.normal == 0u) normal = has(STRATA_FLOOD_ESTIMATE) ? planeNormal(toEye) : toEye;
  if (!(abs(dot(normal, toEye)) > STRATA_FLOOD_EDGE_ON)) return false;
  shape.x = float(pixelOf(seed.pixel).x) + 0.5;
  shape.y = float(pixelOf(seed.pixel).y) + 0.5;
  shape.open = open;
  shape.colour = colours[pixelOf(seed.pixel).y * params.width + pixelOf(seed.pixel).x];
  vec3 across, along;
  shape.radius = axesOf(normal, radius, across, along);
  project(position, normal, across, along, shape);
  return bound(position, normal, shape);
}

void main() {
  ivec2 p = here();
  if (!inside(p)) return;
  uint index = indexAt(p);
  FloodSeed seed = seeds[index];
  FloodShape shape;
  if (seed.pixel == kNone || !make(index, seed, shape)) shape.radius = 0.0;
  shapes[index] = shape;
}
