#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "render/gl/gl_objects.h"
#include "render/gpu/compute_way.h"
#include "render/picture/visibility.h"
#include "render/shaders/shader_types.h"

namespace strata {

/// Rows [first, end) of every view's image, so few that the storage blocks hold them at once.
struct Band {
  int first = 0, end = 0;
};

/// The pixels of several views in GPU memory, one view behind the other. Pictures that are too large for the driver's
/// storage blocks are drawn in bands.
class ComputeTarget {
 public:
  ComputeTarget(const GlFunctions& functions, ComputeWay way);

  /// Takes the sizes of the views, and whether they have sums and counts besides depths and ids. Returns the bands that
  /// together cover the images.
  std::vector<Band> begin(std::span<const VisibilityBuffer> views, bool sums, bool counts);
  /// Clears and binds the pixels of a band, which later calls are about.
  void beginBand(const Band& band);
  /// For compute_lock, where a point was given up: clears the ids and binds what the passes of compute32 need.
  void beginRepair(std::uint64_t candidateWords);
  /// For compute32: makes room for so many words of candidates and binds it.
  void bindCandidates(std::uint64_t words);
  /// Clears and binds the buffer that accumulate.comp writes to.
  void bindSums();
  /// Sets STRATA_UNIFORM_PIXELS in the program in use.
  void setUniforms() const;
  /// Reads the band back into the buffers of the views.
  void read(std::span<VisibilityBuffer> views);

 private:
  /// The rows of one view that the band holds.
  struct ViewRows {
    std::size_t first = 0;   ///< index of their first pixel in the buffers
    int begin = 0, end = 0;  ///< rows
    std::size_t count = 0;
  };

  const GlFunctions& gl_;
  const bool wide_;  ///< depth and id in one 64-bit word
  const bool locked_;
  GlBuffer depths_, ids_, locks_, candidates_, sums_;
  const std::uint64_t largestBlock_;  ///< bytes
  std::vector<int> widths_, heights_;
  std::vector<ViewRows> rows_;  ///< of the band, one per view
  std::size_t pixels_ = 0;      ///< of the band
  bool hasSums_ = false, hasCounts_ = false;
  std::vector<std::uint32_t> hostDepths_, hostIds_;
};

}  // namespace strata
