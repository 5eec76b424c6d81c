#include <algorithm>
#include <cstring>

#include "io/store/bit_packing.h"
#include "io/store/colour_codec.h"
#include "io/store/payload_reader.h"

namespace strata {
namespace {

/// Decodes the grid integers in drawing order.
void decodePositions(PayloadReader& payload, std::vector<std::int64_t> (&grid)[3]) {
  const PayloadHead& head = payload.head();
  const std::size_t count = payload.pointCount();
  const std::span<const std::uint32_t> levelEnds = payload.levelEnds();
  std::vector<Lanes> leading(count);
  payload.openLeading();
  std::size_t first = 0;
  for (const std::uint32_t end : levelEnds) {
    payload.readLeading(first, std::span(leading).subspan(first, end - first));
    first = end;
  }
  if (levelEnds.empty()) payload.readLeading(0, leading);
  payload.closeLeading();
  std::vector<std::uint64_t> offsets[3];
  for (int axis = 0; axis < 3; ++axis) {
    offsets[axis].resize(count);
    const int below = 10 - planeBits(head.bits[axis], 0);
    for (std::size_t i = 0; i < count; ++i) offsets[axis][i] = (leading[i] >> (10 * axis) & 1023u) >> below;
  }
  for (int plane = 1; plane < 3; ++plane) {
    const FieldWidths widths = planeWidths(head, plane);
    BitReader reader(payload.packedPositions(plane).data());
    for (std::size_t i = 0; i < count; ++i)
      for (int axis = 0; axis < 3; ++axis)
        offsets[axis][i] = offsets[axis][i] << widths.axis[axis] | reader.get(widths.axis[axis]);
  }
  std::vector<std::uint64_t> drawn(count);
  for (int axis = 0; axis < 3; ++axis) {
    toDrawingOrder(levelEnds, std::span(drawn), [&](std::size_t from, std::span<std::uint64_t> out) {
      std::copy_n(offsets[axis].begin() + static_cast<std::ptrdiff_t>(from), out.size(), out.begin());
    });
    grid[axis].resize(count);
    for (std::size_t i = 0; i < count; ++i) grid[axis][i] = head.min[axis] + static_cast<std::int64_t>(drawn[i]);
  }
}

/// Sets rgb of every record from its drawn colour and the residual.
void decodeRgb(PayloadReader& payload, const StoreInfo& info, std::size_t offset, std::vector<std::byte>& records) {
  const std::size_t count = payload.pointCount(), stride = info.layout.stride();
  const int ownShift = info.layout.find(attribute::kColourShift);
  std::vector<std::uint32_t> colours;
  decodeDrawnColours(payload, colours);
  const PayloadReader::Plane plane = payload.plane(kColourResidual);
  std::uint16_t unitCode = 0;
  if (plane.stored.size() < sizeof unitCode) payload.fail("colours do not decode");
  std::memcpy(&unitCode, plane.stored.data(), sizeof unitCode);
  const auto unit = static_cast<ResidualUnit>(unitCode);
  if (unit != ResidualUnit::shifted && unit != ResidualUnit::upper && unit != ResidualUnit::repeated)
    payload.fail("colours do not decode");
  std::span<const std::byte> rest = plane.stored.subspan(sizeof unitCode);
  std::vector<std::uint16_t> residuals(count, 0);
  for (std::size_t c = 0; c < 3; ++c) {
    if (plane.encoding != kConstant) decodeComponent(payload, plane, rest, std::span(residuals));
    for (std::size_t i = 0; i < count; ++i) {
      std::byte* record = records.data() + i * stride;
      const int shift = ownShift < 0
                            ? info.colourShift
                            : static_cast<int>(record[info.layout.offset(static_cast<std::size_t>(ownShift))]) & 15;
      const std::uint16_t value = valueOf(unit, residuals[i], colours[i] >> (8 * c) & 255u, shift);
      std::memcpy(record + offset + 2 * c, &value, sizeof value);
    }
  }
  if (!rest.empty()) payload.fail("colours do not decode");
}

}  // namespace

NodePoints decodeAll(const NodeRecord& record, const StoreInfo& info, std::span<const std::byte> bytes) {
  DecodeScratch scratch;
  PayloadReader payload(record, {bytes, 0, bytes}, scratch.buffers());
  const std::size_t count = payload.pointCount();
  NodePoints points;
  decodePositions(payload, points.grid);
  points.levels.assign(payload.levelEnds().begin(), payload.levelEnds().end());

  const PointLayout& layout = info.layout;
  points.attributes.resize(count * layout.stride());
  for (std::size_t a = 0; a < layout.attributes().size(); ++a)
    if (layout.attributes()[a].name != attribute::kRgb)
      decodeAttribute(payload, static_cast<int>(a), layout.attributes()[a], layout.stride(),
                      points.attributes.data() + layout.offset(a));
  // rgb comes last, since the colour shift of a point may be an attribute.
  if (const int rgb = layout.find(attribute::kRgb); rgb >= 0)
    decodeRgb(payload, info, layout.offset(static_cast<std::size_t>(rgb)), points.attributes);
  return points;
}

NodePoints readAll(const Store& store, std::uint32_t nodeIndex) {
  const NodeRecord& record = store.hierarchy().nodes[nodeIndex];
  std::vector<std::byte> bytes(record.payloadBytes);
  store.points().read(record.offset, bytes);
  return decodeAll(record, store.info(), bytes);
}

}  // namespace strata
