#pragma once
#include <cstdint>
#include <optional>

#include "core/view.h"
#include "lod/selection.h"

namespace strata {

/// The views and options that an LOD pass works on.
struct LodTask {
  View view;
  std::optional<View> ahead;  ///< where the camera will soon be
  SelectionOptions selection;
  std::uint64_t generation = 0;  ///< grows with every change of the others
};

}  // namespace strata
