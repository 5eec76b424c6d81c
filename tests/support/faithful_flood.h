#pragma once
#include "render/flood/flood_seeds.h"

namespace strata::test {

/// Settings that fill holes as Farias 2014 prints it: circles around the 4 closest neighbours, which lie no farther
/// apart than `share` of `scale`, the longest side of the model, and within 0.05 of it of each other's planes. The
/// paper takes shares from 0.01, where the points are dense, to 0.1.
inline FloodSettings faithfulFlood(float scale, float share) {
  FloodSettings settings;
  settings.reachMetres = share * scale;
  settings.continuity = 0.05f / share;
  settings.sectors = settings.estimateNormals = settings.ellipses = settings.keepFront = false;
  return settings;
}

}  // namespace strata::test
