#pragma once
#include <glm/gtc/type_precision.hpp>
#include <vector>

#include "core/frame.h"
#include "render/thread_pool.h"
#include "render/visibility.h"

namespace strata {

/// Lets every point cover a square of `pointSize` pixels: a pixel takes the nearest of the points that cover it.
/// A point at column p covers columns p - (pointSize - 1) / 2 to p + pointSize / 2; rows likewise.
void dilate(VisibilityBuffer& buffer, int pointSize, const ThreadPool& pool);

/// Eye-dome lighting (Boucheny 2009): darkens a pixel by how far its eight neighbours stand in front of it,
/// in log2 of the depth, so that the effect does not depend on the scene's scale. The background stays.
void eyeDomeLighting(Frame& frame, float strength, const ThreadPool& pool);

}  // namespace strata
