#include "render/cpu_kernel.h"

// Vectors are members of structs below, which the types without a fixed size cannot be.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/cpu_kernel.cpp"  // compiled once for each instruction set
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
using Words = hn::Vec<decltype(kWord)>;
using Mask = hn::Mask<decltype(kFloat)>;

struct Cells {
  Words x, y, z;
};

/// Appends the ten bits an axis of one plane's words.
HWY_INLINE Cells append(Cells cells, Words word) {
  const Words mask = hn::Set(kWord, 1023u);
  return {hn::Or(hn::ShiftLeft<10>(cells.x), hn::And(word, mask)),
          hn::Or(hn::ShiftLeft<10>(cells.y), hn::And(hn::ShiftRight<10>(word), mask)),
          hn::Or(hn::ShiftLeft<10>(cells.z), hn::And(hn::ShiftRight<20>(word), mask))};
}

struct Row {
  explicit Row(const glm::vec4& row)
      : x(hn::Set(kFloat, row.x)), y(hn::Set(kFloat, row.y)), z(hn::Set(kFloat, row.z)), base(hn::Set(kFloat, row.w)) {}
  HWY_INLINE Floats operator()(Floats cx, Floats cy, Floats cz) const {
    return hn::MulAdd(cx, x, hn::MulAdd(cy, y, hn::MulAdd(cz, z, base)));
  }
  Floats x, y, z, base;
};

/// The transform of batch_plan.h over one vector of points at a time.
template <int kPlanes>
class Projector {
 public:
  Projector(const BatchTransform& t, const Viewport& v)
      : x_(t.x), y_(t.y), depth_(t.depth), offset_(t.offset), shift_(t.shift), view_(v) {}

  /// Appends the points of `lanes` that are in the image; returns their number.
  HWY_INLINE std::size_t project(const std::uint32_t* const planes[3], std::size_t at, Mask lanes,
                                 std::uint32_t firstId, std::size_t written, ProjectedBlock& out) const {
    const Words zero = hn::Zero(kWord);
    Cells cells = append({zero, zero, zero}, hn::LoadU(kWord, planes[0] + at));
    if constexpr (kPlanes > 1) cells = append(cells, hn::LoadU(kWord, planes[1] + at));
    if constexpr (kPlanes > 2) cells = append(cells, hn::LoadU(kWord, planes[2] + at));
    const Floats cx = steps(cells.x, 0), cy = steps(cells.y, 1), cz = steps(cells.z, 2);

    const Floats one = hn::Set(kFloat, 1.0f);
    const Floats depth = depth_(cx, cy, cz);
    const Floats inverse = view_.perspective ? hn::Div(one, depth) : one;
    const Floats column = hn::MulAdd(x_(cx, cy, cz), inverse, hn::Set(kFloat, view_.halfWidth));
    const Floats row = hn::MulAdd(y_(cx, cy, cz), inverse, hn::Set(kFloat, view_.halfHeight));

    const Floats none = hn::Zero(kFloat);
    const Mask inColumns = hn::And(hn::Ge(column, none), hn::Lt(column, hn::Set(kFloat, view_.width)));
    const Mask inRows = hn::And(hn::Ge(row, none), hn::Lt(row, hn::Set(kFloat, view_.height)));
    const Mask inFront = hn::And(lanes, hn::Ge(depth, hn::Set(kFloat, view_.nearDepth)));
    const Mask inside = hn::And(inFront, hn::And(inColumns, inRows));
    if (hn::AllFalse(kFloat, inside)) return 0;

    const auto width = hn::Set(kInt, static_cast<std::int32_t>(view_.width));
    const auto pixel = hn::Add(hn::Mul(hn::ConvertTo(kInt, row), width), hn::ConvertTo(kInt, column));
    const Words id = hn::Iota(kWord, static_cast<std::uint32_t>(firstId + at));
    const auto keep = hn::RebindMask(kWord, inside);
    // Compress and store, not CompressStore: compressing into memory is microcode on Zen 4, many times slower.
    hn::StoreU(hn::Compress(hn::BitCast(kWord, pixel), keep), kWord, out.pixel + written);
    hn::StoreU(hn::Compress(hn::BitCast(kWord, depth), keep), kWord, out.depthBits + written);
    hn::StoreU(hn::Compress(id, keep), kWord, out.id + written);
    return hn::CountTrue(kWord, keep);
  }

 private:
  HWY_INLINE Floats steps(Words cells, int axis) const {
    const Words shifted =
        shift_[axis] < 0 ? hn::ShiftRightSame(cells, -shift_[axis]) : hn::ShiftLeftSame(cells, shift_[axis]);
    return hn::ConvertTo(kFloat, hn::Add(hn::BitCast(kInt, shifted), hn::Set(kInt, offset_[axis])));
  }

  Row x_, y_, depth_;
  glm::ivec3 offset_, shift_;
  const Viewport& view_;
};

template <int kPlanes>
std::size_t projectAll(const BatchTransform& transform, const Viewport& viewport, const std::uint32_t* const planes[3],
                       std::size_t count, std::uint32_t firstId, ProjectedBlock& out) {
  const Projector<kPlanes> projector(transform, viewport);
  const std::size_t lanes = hn::Lanes(kFloat);
  const Mask all = hn::FirstN(kFloat, lanes);
  std::size_t written = 0;
  std::size_t at = 0;
  for (; at + lanes <= count; at += lanes) written += projector.project(planes, at, all, firstId, written, out);
  if (at < count) {
    std::uint32_t tail[3][HWY_MAX_BYTES / sizeof(std::uint32_t)] = {};
    const std::uint32_t* tailPlanes[3] = {tail[0], tail[1], tail[2]};
    for (int p = 0; p < kPlanes; ++p)
      for (std::size_t i = at; i < count; ++i) tail[p][i - at] = planes[p][i];
    written += projector.project(tailPlanes, 0, hn::FirstN(kFloat, count - at),
                                 static_cast<std::uint32_t>(firstId + at), written, out);
  }
  return written;
}

std::size_t project(const BatchTransform& transform, const Viewport& viewport, const std::uint32_t* const planes[3],
                    Precision precision, std::size_t count, std::uint32_t firstId, ProjectedBlock& out) {
  switch (precision) {
    case Precision::low10:
      return projectAll<1>(transform, viewport, planes, count, firstId, out);
    case Precision::medium20:
      return projectAll<2>(transform, viewport, planes, count, firstId, out);
    case Precision::full30:
      return projectAll<3>(transform, viewport, planes, count, firstId, out);
  }
  return 0;
}

const char* targetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace strata
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata {

HWY_EXPORT(project);
HWY_EXPORT(targetName);

std::size_t projectPoints(const BatchTransform& transform, const Viewport& viewport,
                          const std::uint32_t* const planes[3], Precision precision, std::size_t count,
                          std::uint32_t firstId, ProjectedBlock& out) {
  return HWY_DYNAMIC_DISPATCH(project)(transform, viewport, planes, precision, count, firstId, out);
}

const char* kernelTarget() { return HWY_DYNAMIC_DISPATCH(targetName)(); }

}  // namespace strata
#endif
