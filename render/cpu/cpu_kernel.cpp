#include "render/cpu/cpu_kernel.h"

#include <algorithm>
#include <bit>
#include <cmath>

// Structs below have vectors as members, which is impossible for the vector types without a fixed size.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/cpu/cpu_kernel.cpp"  // compiled once for each instruction set
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

constexpr hn::ScalableTag<float> kFloat{};
constexpr hn::RebindToSigned<hn::ScalableTag<float>> kInt{};
constexpr hn::RebindToUnsigned<hn::ScalableTag<float>> kWord{};
using Floats = hn::Vec<decltype(kFloat)>;
using Ints = hn::Vec<decltype(kInt)>;
using Words = hn::Vec<decltype(kWord)>;
using Mask = hn::Mask<decltype(kFloat)>;

/// How coordinates become d, the grid steps as floats. With 10 or 20 bits and an offset that a float holds exactly, one
/// fused multiply-add of floats rounds once, and so gives the same bits as converting the integer D. Everything else is
/// computed in integers.
enum class Steps { floats, integers };

/// The memory that one vector of points is read from.
struct VectorSource {
  const std::uint32_t* planes[3];
  const std::uint32_t* keep;
};

/// Coordinates X of one vector of points.
struct Cells {
  Words x, y, z;
};

/// Appends the ten bits per axis that one plane's words hold.
HWY_INLINE Cells append(Cells cells, Words word) {
  const Words mask = hn::Set(kWord, 1023u);
  return {hn::Or(hn::ShiftLeft<10>(cells.x), hn::And(word, mask)),
          hn::Or(hn::ShiftLeft<10>(cells.y), hn::And(hn::ShiftRight<10>(word), mask)),
          hn::Or(hn::ShiftLeft<10>(cells.z), hn::And(hn::ShiftRight<20>(word), mask))};
}

/// The coordinates of one vector of points, which all views share. If there is only one plane, y and z stay at their
/// bits 10 and 20 of the word; the shift of the Projector makes up for that.
template <int kPlanes, Steps kSteps>
struct Coordinates {
  static constexpr int kStands[3] = {0, kPlanes == 1 ? 10 : 0, kPlanes == 1 ? 20 : 0};

  explicit HWY_INLINE Coordinates(const VectorSource& from) {
    if constexpr (kPlanes == 1) {
      const Words word = hn::LoadU(kWord, from.planes[0]);
      cells = {hn::And(word, hn::Set(kWord, 1023u)), hn::And(word, hn::Set(kWord, 1023u << 10)),
               hn::And(word, hn::Set(kWord, 1023u << 20))};
    } else {
      const Words zero = hn::Zero(kWord);
      cells = append({zero, zero, zero}, hn::LoadU(kWord, from.planes[0]));
      cells = append(cells, hn::LoadU(kWord, from.planes[1]));
      if constexpr (kPlanes > 2) cells = append(cells, hn::LoadU(kWord, from.planes[2]));
    }
    if constexpr (kSteps == Steps::floats) {
      x = hn::ConvertTo(kFloat, hn::BitCast(kInt, cells.x));
      y = hn::ConvertTo(kFloat, hn::BitCast(kInt, cells.y));
      z = hn::ConvertTo(kFloat, hn::BitCast(kInt, cells.z));
    }
  }

  Cells cells;
  Floats x, y, z;  ///< of `cells`; Steps::floats only
};

struct Row {
  explicit HWY_INLINE Row(const glm::vec4& row)
      : x(hn::Set(kFloat, row.x)), y(hn::Set(kFloat, row.y)), z(hn::Set(kFloat, row.z)), base(hn::Set(kFloat, row.w)) {}
  HWY_INLINE Floats operator()(Floats cx, Floats cy, Floats cz) const {
    return hn::MulAdd(cx, x, hn::MulAdd(cy, y, hn::MulAdd(cz, z, base)));
  }
  Floats x, y, z, base;
};

/// The arithmetic of grid_transform.h for one view, on one vector of points at a time.
template <int kPlanes, Steps kSteps>
class Projector {
 public:
  explicit HWY_INLINE Projector(const KernelView& v)
      : x_(v.x),
        y_(v.y),
        depth_(v.depth),
        halfWidth_(hn::Set(kFloat, v.port.halfWidth)),
        halfHeight_(hn::Set(kFloat, v.port.halfHeight)),
        width_(hn::Set(kInt, static_cast<std::int32_t>(v.port.width))),
        corner_(hn::Set(kInt, static_cast<std::int32_t>(v.port.top) * static_cast<std::int32_t>(v.port.width) +
                                  static_cast<std::int32_t>(v.port.left))),
        view_(v) {
    for (int axis = 0; axis < 3; ++axis) {
      shift_[axis] = v.shift[axis] - Coordinates<kPlanes, kSteps>::kStands[axis];
      scale_[axis] = hn::Set(kFloat, std::ldexp(1.0f, shift_[axis]));
      offset_[axis] = hn::Set(kFloat, static_cast<float>(v.offset[axis]));
    }
  }

  /// Appends the points of one vector that are wanted to `out`.
  template <Wanted kWanted>
  HWY_INLINE void project(const Coordinates<kPlanes, kSteps>& c, Mask lanes, std::uint32_t firstId,
                          ProjectedBlock& out) const {
    const Floats dx = steps(c.x, c.cells.x, 0), dy = steps(c.y, c.cells.y, 1), dz = steps(c.z, c.cells.z, 2);
    const Floats depth = depth_(dx, dy, dz);
    const Floats inverse = view_.port.perspective ? hn::Div(hn::Set(kFloat, 1.0f), depth) : hn::Set(kFloat, 1.0f);
    const Floats column = hn::MulAdd(x_(dx, dy, dz), inverse, halfWidth_);
    const Floats row = hn::MulAdd(y_(dx, dy, dz), inverse, halfHeight_);
    Mask wanted = lanes;
    if (!view_.inside) wanted = hn::And(wanted, inImage(column, row, depth));
    if (view_.clip != nullptr) wanted = hn::And(wanted, inClip(dx, dy, dz));
    if (!view_.inside && hn::AllFalse(kFloat, wanted)) return;

    Ints pixel = hn::Add(hn::Mul(hn::ConvertTo(kInt, row), width_), hn::Sub(hn::ConvertTo(kInt, column), corner_));
    // Lanes outside the image must not be gathered, so they read pixel 0.
    if constexpr (kWanted != Wanted::all) {
      if (!view_.inside) pixel = hn::IfThenElseZero(hn::RebindMask(kInt, wanted), pixel);
      const Floats front = frontDepth(pixel);
      wanted = hn::And(
          wanted,
          hn::Le(depth, kWanted == Wanted::front ? front : hn::Mul(front, hn::Set(kFloat, DrawOptions::kBlendDepth))));
    }
    const Words id = hn::Iota(kWord, firstId);
    const auto keep = hn::RebindMask(kWord, wanted);
    // Not CompressStore: compressing straight into memory is microcode on Zen 4, and many times slower.
    hn::StoreU(hn::Compress(hn::BitCast(kWord, pixel), keep), kWord, out.pixel + out.count);
    hn::StoreU(hn::Compress(hn::BitCast(kWord, depth), keep), kWord, out.depthBits + out.count);
    hn::StoreU(hn::Compress(id, keep), kWord, out.id + out.count);
    out.count += hn::CountTrue(kWord, keep);
  }

 private:
  HWY_INLINE Floats steps(Floats asFloats, Words cells, int axis) const {
    if constexpr (kSteps == Steps::floats) return hn::MulAdd(asFloats, scale_[axis], offset_[axis]);
    const Words shifted =
        shift_[axis] < 0 ? hn::ShiftRightSame(cells, -shift_[axis]) : hn::ShiftLeftSame(cells, shift_[axis]);
    return hn::ConvertTo(kFloat, hn::Add(hn::BitCast(kInt, shifted), hn::Set(kInt, view_.offset[axis])));
  }

  HWY_INLINE Mask inImage(Floats column, Floats row, Floats depth) const {
    const Viewport& port = view_.port;
    const Mask inColumns =
        hn::And(hn::Ge(column, hn::Set(kFloat, port.left)), hn::Lt(column, hn::Set(kFloat, port.left + port.width)));
    const Mask inRows =
        hn::And(hn::Ge(row, hn::Set(kFloat, port.top)), hn::Lt(row, hn::Set(kFloat, port.top + port.height)));
    return hn::And(hn::Ge(depth, hn::Set(kFloat, view_.port.nearDepth)), hn::And(inColumns, inRows));
  }

  HWY_INLINE Mask inClip(Floats dx, Floats dy, Floats dz) const {
    const auto within = [](Floats d, float lo, float hi) {
      return hn::And(hn::Ge(d, hn::Set(kFloat, lo)), hn::Le(d, hn::Set(kFloat, hi)));
    };
    const auto inBox = [&](const ClipSteps& box) {
      return hn::And(within(dx, box.lo.x, box.hi.x),
                     hn::And(within(dy, box.lo.y, box.hi.y), within(dz, box.lo.z, box.hi.z)));
    };
    Mask kept = view_.clip->clipBoxes.empty() ? hn::FirstN(kFloat, hn::Lanes(kFloat)) : hn::FirstN(kFloat, 0);
    for (const ClipSteps& box : view_.clip->clipBoxes) kept = hn::Or(kept, inBox(box));
    for (const ClipSteps& box : view_.clip->clipCutouts) kept = hn::AndNot(inBox(box), kept);
    for (const glm::vec4& plane : view_.clip->clipPlanes)
      kept = hn::And(kept, hn::Ge(Row(plane)(dx, dy, dz), hn::Zero(kFloat)));
    return kept;
  }

  /// The depths in the upper halves of 64-bit pixels.
  HWY_INLINE Floats frontDepth(Ints pixel) const {
    constexpr int kHigh = std::endian::native == std::endian::little ? 1 : 0;
    const auto* words = reinterpret_cast<const float*>(view_.pixels);
    return hn::GatherIndex(kFloat, words + kHigh, hn::ShiftLeft<1>(pixel));
  }

  Row x_, y_, depth_;
  Floats halfWidth_, halfHeight_;
  Ints width_, corner_;  ///< columns of the image; index of its first pixel, counted from the picture's origin
  Floats scale_[3], offset_[3];
  int shift_[3];
  const KernelView& view_;
};

template <int kPlanes, Steps kSteps, Wanted kWanted, int kViews>
class BlockProjector {
 public:
  BlockProjector(const KernelView* views, ProjectedBlock* blocks)
      : first_(views[0]), last_(views[kViews - 1]), blocks_(blocks) {}

  void projectAll(const KernelPoints& points) const {
    const std::size_t lanes = hn::Lanes(kFloat);
    const Mask all = hn::FirstN(kFloat, lanes);
    std::size_t at = 0;
    for (; at + lanes <= points.count; at += lanes) {
      VectorSource from{{}, points.keep == nullptr ? nullptr : points.keep + at};
      for (int p = 0; p < kPlanes; ++p) from.planes[p] = points.planes[p] + at;
      project(from, all, static_cast<std::uint32_t>(points.firstId + at));
    }
    if (at == points.count) return;
    // The last points do not fill a vector. They are copied, because reading beyond the planes may fault.
    std::uint32_t tail[4][HWY_MAX_BYTES / sizeof(std::uint32_t)] = {};
    for (int p = 0; p < kPlanes; ++p) std::copy(points.planes[p] + at, points.planes[p] + points.count, tail[p]);
    if (points.keep != nullptr) std::copy(points.keep + at, points.keep + points.count, tail[3]);
    project({{tail[0], tail[1], tail[2]}, points.keep == nullptr ? nullptr : tail[3]},
            hn::FirstN(kFloat, points.count - at), static_cast<std::uint32_t>(points.firstId + at));
  }

 private:
  HWY_INLINE void project(const VectorSource& from, Mask drawn, std::uint32_t firstId) const {
    const Coordinates<kPlanes, kSteps> coordinates(from);
    if (from.keep != nullptr)
      drawn = hn::And(drawn, hn::RebindMask(kFloat, hn::Ne(hn::LoadU(kWord, from.keep), hn::Zero(kWord))));
    first_.template project<kWanted>(coordinates, drawn, firstId, blocks_[0]);
    if constexpr (kViews > 1) last_.template project<kWanted>(coordinates, drawn, firstId, blocks_[1]);
  }

  Projector<kPlanes, kSteps> first_, last_;
  ProjectedBlock* blocks_;
};

template <int kPlanes, Steps kSteps, Wanted kWanted, int kViews>
void projectBlock(const KernelPoints& points, const KernelView* views, ProjectedBlock* blocks) {
  BlockProjector<kPlanes, kSteps, kWanted, kViews>(views, blocks).projectAll(points);
}

template <int kPlanes, Steps kSteps, int kViews>
void projectWanted(const KernelPoints& points, const KernelView* views, Wanted wanted, ProjectedBlock* blocks) {
  if (wanted == Wanted::all) projectBlock<kPlanes, kSteps, Wanted::all, kViews>(points, views, blocks);
  if (wanted == Wanted::front) projectBlock<kPlanes, kSteps, Wanted::front, kViews>(points, views, blocks);
  if (wanted == Wanted::near) projectBlock<kPlanes, kSteps, Wanted::near, kViews>(points, views, blocks);
}

template <int kViews>
void projectViews(const KernelPoints& points, const KernelView* views, Wanted wanted, ProjectedBlock* blocks) {
  bool floats = true;
  for (int v = 0; v < kViews; ++v)
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t offset = views[v].offset[axis];
      floats = floats && static_cast<std::int64_t>(static_cast<float>(offset)) == offset;
    }
  switch (points.precision) {
    case Precision::low10:
      return floats ? projectWanted<1, Steps::floats, kViews>(points, views, wanted, blocks)
                    : projectWanted<1, Steps::integers, kViews>(points, views, wanted, blocks);
    case Precision::medium20:
      return floats ? projectWanted<2, Steps::floats, kViews>(points, views, wanted, blocks)
                    : projectWanted<2, Steps::integers, kViews>(points, views, wanted, blocks);
    case Precision::full30:
      return projectWanted<3, Steps::integers, kViews>(points, views, wanted, blocks);
  }
}

void project(const KernelPoints& points, const KernelView* views, int viewCount, Wanted wanted,
             ProjectedBlock* blocks) {
  for (int v = 0; v < viewCount; ++v) blocks[v].count = 0;
  if (viewCount == 1) projectViews<1>(points, views, wanted, blocks);
  if (viewCount == 2) projectViews<2>(points, views, wanted, blocks);
}

void merge(PackedPixel* into, PackedPixel* from, std::size_t count) {
  const hn::ScalableTag<std::uint64_t> tag;
  const auto empty = hn::Set(tag, kEmptyPixel);
  std::size_t i = 0;
  for (; i + hn::Lanes(tag) <= count; i += hn::Lanes(tag)) {
    hn::StoreU(hn::Min(hn::LoadU(tag, into + i), hn::LoadU(tag, from + i)), tag, into + i);
    hn::StoreU(empty, tag, from + i);
  }
  for (; i < count; ++i) {
    into[i] = std::min(into[i], from[i]);
    from[i] = kEmptyPixel;
  }
}

const char* targetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace strata
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata {

HWY_EXPORT(project);
HWY_EXPORT(merge);
HWY_EXPORT(targetName);

void projectPoints(const KernelPoints& points, const KernelView* views, int viewCount, Wanted wanted,
                   ProjectedBlock* blocks) {
  HWY_DYNAMIC_DISPATCH(project)(points, views, viewCount, wanted, blocks);
}

void mergePixels(PackedPixel* into, PackedPixel* from, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(merge)(into, from, count);
}

const char* kernelTarget() { return HWY_DYNAMIC_DISPATCH(targetName)(); }

}  // namespace strata
#endif
