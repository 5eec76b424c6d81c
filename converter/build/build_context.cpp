#include "converter/build/build_context.h"

#include <algorithm>

namespace strata {
namespace {

constexpr int kLocalBits = 31;

}  // namespace

CellCoordinates::CellCoordinates(const BuildContext& context, NodeKey cell) {
  const int cellBits = context.info.cubeBits - cell.level();
  inside = (std::int64_t{1} << cellBits) - 1;
  bits = std::min(cellBits, kLocalBits);
  shift = cellBits - bits;
  corner = nodeCube(cell, context.info.rootCube()).min;
  step = context.info.grid.scale * static_cast<double>(std::int64_t{1} << shift);
}

}  // namespace strata
