#pragma once
#include "core/draw_options.h"
#include "core/picture.h"
#include "core/render_list.h"
#include "render/picture/visibility.h"
#include "render/thread_pool.h"

namespace strata {

class GlFlood;

/// The second half of every draw: point size, ids to colours, eye-dome lighting. `buffer` is used up; its ids must be
/// those of `list`. `flood` fills holes where DrawOptions::jumpFlood asks for it; without, the CPU does.
void resolveFrame(const RenderList& list, const View& view, const DrawOptions& options, VisibilityBuffer& buffer,
                  const ThreadPool& pool, Picture& frame, GlFlood* flood = nullptr);

}  // namespace strata
