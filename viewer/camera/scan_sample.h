#pragma once
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "core/box.h"
#include "core/view.h"
#include "io/store/store.h"

namespace strata {

/// A spatially even sample of a scan's points, from which camera positions are chosen.
struct ScanSample {
  Box bounds;                      ///< around the data, without lone points far off
  std::vector<glm::dvec3> points;  ///< inside bounds, evenly spread over the surfaces
  double spacing = 0.0;            ///< typical distance between neighbours in `points`, metres
  bool enclosed = false;           ///< a room or a tunnel: floor below and ceiling above nearly everywhere

  double diagonal() const { return bounds.diagonal(); }
  /// The height divided by the horizontal extent: near 0 for a landscape, above 0.5 for a statue.
  double tallness() const;
};

/// `points` may be in any order. Without points the bounds are a unit box.
ScanSample makeScanSample(std::vector<glm::dvec3> points);

inline constexpr std::uint64_t kSampledPoints = 300'000;
/// Reads the upper levels of the store, about kSampledPoints points at most. Throws Error when a node is damaged.
ScanSample sampleStore(const Store& store);

/// The deepest node whose cell holds a place; its spacing says how densely the place was scanned.
struct LocalNode {
  std::uint32_t index = 0;
  double spacing = 0.0;  ///< metres between the node's points
};
LocalNode localNode(const Store& store, const glm::dvec3& place);

/// Ground and obstacles on a horizontal grid over ScanSample::bounds.
class HeightGrid {
 public:
  static constexpr int kCells = 48;  ///< along the longer side

  explicit HeightGrid(const ScanSample& scan);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  bool hasData(int column, int row) const { return count_[index(column, row)] > 0; }
  double ground(int column, int row) const { return ground_[index(column, row)]; }
  /// The height of the cell's highest point.
  double top(int column, int row) const { return top_[index(column, row)]; }
  glm::dvec2 centre(int column, int row) const;
  /// The cell that holds `place`, or the nearest one where `place` is outside of the grid.
  glm::ivec2 cellOf(const glm::dvec2& place) const;
  double cellSize() const { return cell_; }

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }

  glm::dvec2 origin_{0.0};
  double cell_ = 1.0;
  int columns_ = 1, rows_ = 1;
  std::vector<int> count_;
  std::vector<double> ground_, top_;  ///< cells without data have the values of the nearest cell with data
};

}  // namespace strata
