#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "render/gl/gl_objects.h"
#include "render/gpu/compute_way.h"
#include "render/picture/visibility.h"
#include "render/shaders/shader_types.h"

namespace strata {

/// Rows [first, end) of every view's image: as much as storage blocks hold at once.
struct Band {
  int first = 0, end = 0;
};

/// Pixels of some views on the GPU, one view after the other.
class ComputeTarget {
 public:
  ComputeTarget(const GlFunctions& functions, ComputeWay way);

  /// Sets the views' sizes and what there is a buffer for beside depth and id. Returns the bands of the images.
  std::vector<Band> begin(std::span<const VisibilityBuffer> views, bool sums, bool counts);
  /// Clears the pixels of a band and binds them.
  void beginBand(const Band& band);
  /// Clears the ids and binds what compute32's passes need: for compute_lock, where a point was given up.
  void beginRepair(std::uint64_t candidateWords);
  /// compute32: room for its candidates.
  void bindCandidates(std::uint64_t words);
  /// Binds what accumulate.comp writes, cleared.
  void bindSums();
  /// Of the band, in the program in use.
  void setUniforms() const;
  /// Reads the band back.
  void read(std::span<VisibilityBuffer> views);

 private:
  struct ViewRows {
    std::size_t first = 0;   ///< pixel in the buffers
    int begin = 0, end = 0;  ///< rows
    std::size_t count = 0;
  };

  const GlFunctions& gl_;
  const bool wide_;  ///< depth and id in one 64-bit word
  const bool locked_;
  GlBuffer depths_, ids_, locks_, candidates_, sums_;
  const std::uint64_t largestBlock_;  ///< bytes
  std::vector<int> widths_, heights_;
  std::vector<ViewRows> rows_;  ///< of the band, one a view
  std::size_t pixels_ = 0;      ///< of the band
  bool hasSums_ = false, hasCounts_ = false;
  std::vector<std::uint32_t> hostDepths_, hostIds_;
};

}  // namespace strata
