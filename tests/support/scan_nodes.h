#pragma once
#include <string>

#include "core/render_list.h"

namespace strata::test {

/// At most `mostPoints` points of a scan (every k-th), a path or synthetic:NAME, in Morton order, in nodes of at most
/// 40 000 points on the scan's own grid. Colours as makeNode() gives. Throws Error where it cannot be read.
RenderList scanAsNodes(const std::string& scan, std::size_t mostPoints);

}  // namespace strata::test
