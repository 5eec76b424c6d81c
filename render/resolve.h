#pragma once
#include "core/frame.h"
#include "core/render_list.h"
#include "render/thread_pool.h"
#include "render/visibility.h"

namespace strata {

class GlFlood;

/// The second half of every draw: point size, ids to colours, eye-dome lighting. `buffer` is used up; its ids must be
/// those of `list`. `flood` fills holes where DrawOptions::jumpFlood asks for it; without, the CPU does.
void resolveFrame(const RenderList& list, const View& view, const DrawOptions& options, VisibilityBuffer& buffer,
                  const ThreadPool& pool, Frame& frame, GlFlood* flood = nullptr);

}  // namespace strata
