#include "render/rasterizer.h"

#include <algorithm>

namespace strata {

void addStats(const DrawStats& one, DrawStats& sum) {
  sum.pointsDrawn += one.pointsDrawn;
  sum.batchesDrawn += one.batchesDrawn;
  sum.batchesCulled += one.batchesCulled;
  for (int p = 0; p < 3; ++p) sum.batchesAt[p] += one.batchesAt[p];
  sum.nodesNotUploaded = std::max(sum.nodesNotUploaded, one.nodesNotUploaded);
  sum.bytesUploaded += one.bytesUploaded;
  sum.gpuBytes = std::max(sum.gpuBytes, one.gpuBytes);
  sum.pointsPending = std::max(sum.pointsPending, one.pointsPending);
  sum.lockRetries += one.lockRetries;
  sum.lockRepairs += one.lockRepairs;
  sum.uploadMs += one.uploadMs;
  sum.drawMs += one.drawMs;
  sum.resolveMs += one.resolveMs;
  sum.gpuMs += one.gpuMs;
}

DrawStats Rasterizer::drawViews(const RenderList& list, std::span<const View> views, const DrawOptions& options,
                                std::span<Picture> pictures) {
  DrawStats sum;
  for (std::size_t i = 0; i < std::min(views.size(), pictures.size()); ++i)
    addStats(draw(list, views[i], options, pictures[i]), sum);
  return sum;
}

}  // namespace strata
