#pragma once
#include "core/draw_options.h"
#include "core/picture.h"
#include "core/render_list.h"
#include "render/picture/visibility.h"
#include "render/thread_pool.h"

namespace strata {

class GlFlood;

/// What was drawn: a list, as a view sees it, in the way that the options say.
struct DrawnScene {
  const RenderList& list;
  const View& view;
  const DrawOptions& options;
};

/// Tools that resolving uses and that outlive a picture.
struct ResolveTools {
  const ThreadPool& pool;
  GlFlood* flood = nullptr;  ///< fills holes where DrawOptions::jumpFlood asks for it; null: the CPU fills them
};

/// The second half of every draw: makes points as large as asked, turns ids into colours, fills holes and lights the
/// picture. `buffer` is used up; its ids must be those of the list. `picture` is resized to the buffer.
void resolvePicture(const DrawnScene& drawn, const ResolveTools& tools, VisibilityBuffer& buffer, Picture& picture);

}  // namespace strata
