// The pages of the point pool as one array. Each page is a block of its own, because a driver may not bind a block as
// large as the pool.
layout(std430, binding = 0) buffer Page0 { uvec4 page0[]; };
layout(std430, binding = 1) buffer Page1 { uvec4 page1[]; };
layout(std430, binding = 2) buffer Page2 { uvec4 page2[]; };
layout(std430, binding = 3) buffer Page3 { uvec4 page3[]; };
layout(std430, binding = STRATA_BINDING_PERMUTATION) readonly buffer Permutation { uint permutation[]; };

layout(location = STRATA_UNIFORM_PAGE_POINTS) uniform uint pagePoints;

void putPoint(uint index, uvec4 point) {
  uint place = permutation[index], page = place / pagePoints, at = place % pagePoints;
  if (page == 0u) page0[at] = point;
  else if (page == 1u) page1[at] = point;
  else if (page == 2u) page2[at] = point;
  else page3[at] = point;
}

uvec4 pointAt(uint index) {
  uint place = permutation[index], page = place / pagePoints, at = place % pagePoints;
  return page == 0u ? page0[at] : page == 1u ? page1[at] : page == 2u ? page2[at] : page3[at];
}
