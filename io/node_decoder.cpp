#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

#include "core/error.h"
#include "core/octahedral.h"
#include "io/attribute_codec.h"
#include "io/bit_packing.h"
#include "io/checksum.h"
#include "io/colour_codec.h"
#include "io/node_codec.h"
#include "io/payload_head.h"
#include "io/position_codec.h"

namespace strata {
namespace {

/// The parts of one payload, every length checked against the record and against each other.
class PayloadReader {
 public:
  PayloadReader(const NodeRecord& record, std::span<const std::byte> payload)
      : PayloadReader(record, payload, 0, payload) {}
  /// `part` is what of the payload is at hand, from `from` on.
  PayloadReader(const NodeRecord& record, std::span<const std::byte> head, std::size_t from,
                std::span<const std::byte> part)
      : record_(record), payload_(part), from_(from), parsed_(parseHead(record, head)) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw Error("points.bin", "node " + NodeKey{record_.key}.text() + ": " + what);
  }
  const PayloadHead& head() const { return parsed_.head; }
  std::span<const std::uint32_t> levelEnds() const { return parsed_.levelEnds; }
  std::size_t pointCount() const { return record_.pointCount; }
  bool has(std::uint16_t id) const {
    return std::any_of(parsed_.planes.begin(), parsed_.planes.end(),
                       [id](const PayloadPlane& p) { return p.id == id; });
  }
  std::vector<std::uint8_t>& spare() { return spare_; }

  /// Where the plane ends in the payload; 0 when there is none.
  std::size_t endOf(std::uint16_t id) const {
    std::size_t end = record_.headBytes;
    for (const PayloadPlane& p : parsed_.planes) {
      end += p.storedBytes;
      if (p.id == id) return end;
    }
    return 0;
  }
  /// Where the last plane ends that is at hand whole, and all before it.
  std::size_t wholeEnd() const {
    std::size_t end = record_.headBytes;
    for (const PayloadPlane& p : parsed_.planes) {
      if (end + p.storedBytes > from_ + payload_.size()) break;
      end += p.storedBytes;
    }
    return end;
  }
  /// False as well where not all of the plane is at hand, or nothing is stored of it.
  bool holds(std::uint16_t id) const {
    std::size_t begin = record_.headBytes;
    for (const PayloadPlane& p : parsed_.planes) {
      if (p.id == id) return p.storedBytes > 0 && begin >= from_ && begin + p.storedBytes <= from_ + payload_.size();
      begin += p.storedBytes;
    }
    return false;
  }

  /// The stored bytes of a plane, checked, with kBitSlack readable bytes behind them; valid until the next call.
  struct Plane {
    PlaneEncoding encoding;
    std::span<const std::byte> stored;
  };
  Plane plane(std::uint16_t id) {
    std::size_t offset = record_.headBytes;
    for (const PayloadPlane& p : parsed_.planes) {
      if (p.id != id) {
        offset += p.storedBytes;
        continue;
      }
      if (offset < from_ || offset - from_ > payload_.size() || p.storedBytes > payload_.size() - (offset - from_))
        fail("truncated plane");
      offset -= from_;
      const std::span<const std::byte> stored = payload_.subspan(offset, p.storedBytes);
      if (checksum(stored) != p.checksum) fail("block checksum mismatch");
      const auto encoding = static_cast<PlaneEncoding>(p.encoding);
      if (payload_.size() - offset - stored.size() >= kBitSlack) return {encoding, stored};
      stored_.resize(stored.size() + kBitSlack);
      std::copy(stored.begin(), stored.end(), stored_.begin());
      return {encoding, std::span(stored_).first(stored.size())};
    }
    fail("plane " + std::to_string(id) + " is missing");
  }

  /// Values of all points from stored into drawing order.
  template <class T>
  void toDrawingOrder(const std::vector<T>& stored, T* drawn) const {
    std::size_t first = 0;
    for (const std::uint32_t end : parsed_.levelEnds) {
      interleaveLevel(stored.data() + first, end - first, drawn + first);
      first = end;
    }
    if (parsed_.levelEnds.empty()) std::copy(stored.begin(), stored.end(), drawn);
  }

 private:
  const NodeRecord& record_;
  std::span<const std::byte> payload_;
  std::size_t from_;
  ParsedHead parsed_;
  std::vector<std::byte> stored_;
  std::vector<std::uint8_t> spare_;
};

/// Plane 0 in stored order, aligned to the top of 10 bits.
std::vector<Lanes> leadingPositions(PayloadReader& payload) {
  std::vector<Lanes> out(payload.pointCount());
  const PayloadReader::Plane plane = payload.plane(kPosition10);
  const bool fits = plane.encoding == kOctree ? decodeOctree(payload.head(), payload.levelEnds(), plane.stored, out)
                                              : plane.encoding == kPacked && payload.levelEnds().empty() &&
                                                    decodePacked(payload.head(), plane.stored, out);
  if (!fits) payload.fail("positions do not decode");
  return out;
}

/// The checked bit fields of plane 1 or 2.
std::span<const std::byte> packedPositions(PayloadReader& payload, int plane) {
  const PayloadReader::Plane found = payload.plane(static_cast<std::uint16_t>(kPosition10 + plane));
  const std::size_t expected = packedBytes(payload.pointCount(), planeWidths(payload.head(), plane).sum());
  if (found.encoding != kPacked || found.stored.size() != expected) payload.fail("positions do not decode");
  return found.stored;
}

/// Plane 1 or 2 in stored order: its leading 10 bits of each axis.
std::vector<Lanes> finerPositions(PayloadReader& payload, int plane) {
  const std::span<const std::byte> stored = packedPositions(payload, plane);
  const FieldWidths widths = planeWidths(payload.head(), plane);
  std::vector<Lanes> out(payload.pointCount());
  BitReader reader(stored.data());
  if (std::max({widths.axis[0], widths.axis[1], widths.axis[2]}) <= 10) {
    const int left[3] = {10 - widths.axis[0], 20 - widths.axis[1], 30 - widths.axis[2]};
    const std::uint32_t mask[3] = {(1u << widths.axis[0]) - 1, (1u << widths.axis[1]) - 1, (1u << widths.axis[2]) - 1};
    const int second = widths.axis[0], third = widths.axis[0] + widths.axis[1], sum = widths.sum();
    for (Lanes& point : out) {
      const auto fields = static_cast<std::uint32_t>(reader.get(sum));
      point = (fields & mask[0]) << left[0] | (fields >> second & mask[1]) << left[1] |
              (fields >> third & mask[2]) << left[2];
    }
    return out;
  }
  for (Lanes& point : out) {
    Lanes lanes = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int width = widths.axis[axis];
      const std::uint64_t field = reader.get(width);
      lanes |= static_cast<Lanes>(width <= 10 ? field << (10 - width) : field >> (width - 10)) << (10 * axis);
    }
    point = lanes;
  }
  return out;
}

/// Offsets from the minimum, in stored order.
void decodeOffsets(PayloadReader& payload, std::vector<std::uint64_t> (&offsets)[3]) {
  const PayloadHead& head = payload.head();
  const std::vector<Lanes> leading = leadingPositions(payload);
  for (int axis = 0; axis < 3; ++axis) {
    offsets[axis].resize(leading.size());
    const int below = 10 - planeBits(head.bits[axis], 0);
    for (std::size_t i = 0; i < leading.size(); ++i) offsets[axis][i] = (leading[i] >> (10 * axis) & 1023u) >> below;
  }
  for (int plane = 1; plane < 3; ++plane) {
    const FieldWidths widths = planeWidths(head, plane);
    BitReader reader(packedPositions(payload, plane).data());
    for (std::size_t i = 0; i < leading.size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        offsets[axis][i] = offsets[axis][i] << widths.axis[axis] | reader.get(widths.axis[axis]);
  }
}

template <class T>
void decodeComponent(PayloadReader& payload, const PayloadReader::Plane& plane, std::span<const std::byte>& rest,
                     std::vector<T>& stored, std::vector<T>& drawn) {
  stored.resize(payload.pointCount());
  drawn.resize(payload.pointCount());
  if (plane.encoding != kColumns || !takeComponent(rest, payload.spare(), std::span<T>(stored)))
    payload.fail("attribute does not decode");
  payload.toDrawingOrder(stored, drawn.data());
}

template <class T>
void decodeColumns(PayloadReader& payload, const PayloadReader::Plane& plane, const Attribute& attribute,
                   std::size_t stride, std::byte* first) {
  std::span<const std::byte> rest = plane.stored;
  std::vector<T> stored, drawn;
  for (std::size_t c = 0; c < attribute.components; ++c) {
    decodeComponent(payload, plane, rest, stored, drawn);
    for (std::size_t i = 0; i < drawn.size(); ++i)
      std::memcpy(first + i * stride + c * sizeof(T), &drawn[i], sizeof(T));
  }
  if (!rest.empty()) payload.fail("attribute does not decode");
}

/// Into the records from `first` on.
void decodeAttribute(PayloadReader& payload, int layoutIndex, const Attribute& attribute, std::size_t stride,
                     std::byte* first) {
  const PayloadReader::Plane plane = payload.plane(static_cast<std::uint16_t>(kFirstAttributePlane + layoutIndex));
  if (plane.encoding == kConstant) {
    if (plane.stored.size() != attribute.bytes()) payload.fail("constant plane has the wrong size");
    for (std::size_t i = 0; i < payload.pointCount(); ++i)
      std::memcpy(first + i * stride, plane.stored.data(), plane.stored.size());
    return;
  }
  switch (scalarBytes(attribute.type)) {
    case 1:
      return decodeColumns<std::uint8_t>(payload, plane, attribute, stride, first);
    case 2:
      return decodeColumns<std::uint16_t>(payload, plane, attribute, stride, first);
    case 4:
      return decodeColumns<std::uint32_t>(payload, plane, attribute, stride, first);
    default:
      return decodeColumns<std::uint64_t>(payload, plane, attribute, stride, first);
  }
}

/// One-component attribute for drawing.
template <class T>
void decodeValues(PayloadReader& payload, int layoutIndex, std::vector<T>& out) {
  const PayloadReader::Plane plane = payload.plane(static_cast<std::uint16_t>(kFirstAttributePlane + layoutIndex));
  if (plane.encoding == kConstant) {
    T value;
    if (plane.stored.size() != sizeof value) payload.fail("constant plane has the wrong size");
    std::memcpy(&value, plane.stored.data(), sizeof value);
    out.assign(payload.pointCount(), value);
    return;
  }
  std::span<const std::byte> rest = plane.stored;
  std::vector<T> stored;
  decodeComponent(payload, plane, rest, stored, out);
  if (!rest.empty()) payload.fail("attribute does not decode");
}

void decodeDrawnColours(PayloadReader& payload, std::vector<std::uint32_t>& out) {
  const PayloadReader::Plane plane = payload.plane(kColour);
  std::vector<std::uint32_t> stored(payload.pointCount());
  if (plane.encoding != kColumns || !decodeColours(plane.stored, payload.spare(), stored))
    payload.fail("colours do not decode");
  out.resize(stored.size());
  payload.toDrawingOrder(stored, out.data());
}

/// rgb of every record from its drawn colour and the residual.
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
  std::vector<std::uint16_t> stored, residuals(count, 0);
  for (std::size_t c = 0; c < 3; ++c) {
    if (plane.encoding != kConstant) decodeComponent(payload, plane, rest, stored, residuals);
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

/// All batches have the node's box: each holds whole passes over it, so that a tighter one would hardly be smaller.
void describeBatches(const PayloadHead& head, const StoreInfo& info, NodeData& out) {
  const Box cube = nodeCube(out.key, info.rootCube());
  out.origin = cube.min;
  out.batches.clear();
  Batch batch;
  for (int axis = 0; axis < 3; ++axis) {
    const double corner = std::round((cube.min[axis] - info.grid.offset[axis]) / info.grid.scale[axis]);
    batch.boxMin[axis] = (static_cast<double>(head.min[axis]) - corner) * info.grid.scale[axis];
    batch.boxSize[axis] = std::ldexp(info.grid.scale[axis], head.bits[axis]);
    batch.bits[axis] = head.bits[axis];
  }
  for (; batch.firstPoint < head.pointCount; batch.firstPoint += Batch::kMaxPoints) {
    batch.pointCount = std::min(Batch::kMaxPoints, head.pointCount - batch.firstPoint);
    out.batches.push_back(batch);
  }
}

/// What only some ways of drawing look at, where the bytes at hand hold it.
void decodeShown(PayloadReader& payload, const StoreInfo& info, NodeData& out) {
  const auto atHand = [&](int index) {
    return index >= 0 && payload.holds(static_cast<std::uint16_t>(kFirstAttributePlane + index));
  };
  if (const int index = info.layout.find(attribute::kReturnNumber); atHand(index))
    decodeValues(payload, index, out.returnNumber);
  if (const int index = info.layout.find(attribute::kNormal); atHand(index)) {
    std::vector<float> xyz(3 * payload.pointCount());
    decodeAttribute(payload, index, info.layout.attributes()[static_cast<std::size_t>(index)], 3 * sizeof(float),
                    std::as_writable_bytes(std::span(xyz)).data());
    out.normal.resize(payload.pointCount());
    for (std::size_t i = 0; i < out.normal.size(); ++i)
      out.normal[i] = packNormal({xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]});
  } else if (const int octahedral = info.layout.find(attribute::kNormalOctahedral); atHand(octahedral)) {
    std::vector<Octahedral> codes(payload.pointCount());
    decodeAttribute(payload, octahedral, info.layout.attributes()[static_cast<std::size_t>(octahedral)],
                    sizeof(Octahedral), std::as_writable_bytes(std::span(codes)).data());
    out.normal.resize(codes.size());
    for (std::size_t i = 0; i < codes.size(); ++i) out.normal[i] = packNormal(decodeOctahedral(codes[i]));
  }
}

}  // namespace

std::uint32_t drawBytes(const NodeRecord& record, Precision precision) {
  return record.drawBytes[static_cast<int>(precision) - 1];
}

void decodeForDrawing(const NodeRecord& record, const StoreInfo& info, std::span<const std::byte> bytes,
                      Precision precision, NodeData& out) {
  PayloadReader payload(record, bytes);
  out.key = NodeKey{record.key};
  out.spacing = record.spacing;
  describeBatches(payload.head(), info, out);
  for (int plane = 0; plane < 3; ++plane) {
    if (plane >= static_cast<int>(precision)) {
      out.position[plane].clear();
      continue;
    }
    const std::vector<Lanes> stored = plane == 0 ? leadingPositions(payload) : finerPositions(payload, plane);
    out.position[plane].resize(stored.size());
    payload.toDrawingOrder(stored, out.position[plane].data());
  }
  out.colour.clear();
  out.intensity.clear();
  out.classification.clear();
  if (payload.has(kColour)) decodeDrawnColours(payload, out.colour);
  if (const int index = info.layout.find(attribute::kIntensity); index >= 0)
    decodeValues(payload, index, out.intensity);
  if (const int index = info.layout.find(attribute::kClassification); index >= 0)
    decodeValues(payload, index, out.classification);
  out.returnNumber.clear();
  out.normal.clear();
  decodeShown(payload, info, out);
}

PlaneEnds decodePart(const NodeRecord& record, const StoreInfo& info, std::span<const std::byte> head,
                     std::uint32_t from, std::span<const std::byte> bytes, NodeData& out) {
  PayloadReader payload(record, head, from, bytes);
  if (from == 0) {
    out.key = NodeKey{record.key};
    describeBatches(payload.head(), info, out);
    for (auto& plane : out.position) plane.clear();
    out.colour.clear();
    out.intensity.clear();
    out.classification.clear();
    out.returnNumber.clear();
    out.normal.clear();
  }
  const auto end = [&payload](std::uint16_t id) { return static_cast<std::uint32_t>(payload.endOf(id)); };
  const bool isShort = from == 0 && bytes.size() < end(kPosition10) && bytes.size() < record.drawBytes[0];
  for (int plane = 0; plane < 3; ++plane) {
    const auto id = static_cast<std::uint16_t>(kPosition10 + plane);
    const bool isFirst = plane == 0 && from == 0 && !isShort;  // even where it takes no bytes
    if (!payload.holds(id) && !isFirst) continue;
    const std::vector<Lanes> stored = plane == 0 ? leadingPositions(payload) : finerPositions(payload, plane);
    out.position[plane].resize(stored.size());
    payload.toDrawingOrder(stored, out.position[plane].data());
  }
  if (!isShort && out.position[0].size() != payload.pointCount()) payload.fail("not the points that were read before");
  if (payload.holds(kColour)) decodeDrawnColours(payload, out.colour);
  const auto idOf = [&info](std::string_view name) {
    const int index = info.layout.find(name);
    return index < 0 ? std::uint16_t{0xffff} : static_cast<std::uint16_t>(kFirstAttributePlane + index);
  };
  const std::uint16_t intensity = idOf(attribute::kIntensity), classification = idOf(attribute::kClassification);
  if (payload.holds(intensity)) decodeValues(payload, intensity - kFirstAttributePlane, out.intensity);
  if (payload.holds(classification)) decodeValues(payload, classification - kFirstAttributePlane, out.classification);
  decodeShown(payload, info, out);

  PlaneEnds ends;
  ends.whole = static_cast<std::uint32_t>(payload.wholeEnd());
  for (int plane = 0; plane < 3; ++plane) ends.position[plane] = end(static_cast<std::uint16_t>(kPosition10 + plane));
  ends.colour = end(kColour);
  ends.intensity = end(intensity);
  ends.classification = end(classification);
  ends.returnNumber = end(idOf(attribute::kReturnNumber));
  ends.normal = std::max(end(idOf(attribute::kNormal)), end(idOf(attribute::kNormalOctahedral)));
  return ends;
}

NodePoints decodeAll(const NodeRecord& record, const StoreInfo& info, std::span<const std::byte> bytes) {
  PayloadReader payload(record, bytes);
  const std::size_t count = payload.pointCount();
  NodePoints points;
  std::vector<std::uint64_t> offsets[3];
  decodeOffsets(payload, offsets);
  std::vector<std::uint64_t> drawn(count);
  for (int axis = 0; axis < 3; ++axis) {
    payload.toDrawingOrder(offsets[axis], drawn.data());
    points.grid[axis].resize(count);
    for (std::size_t i = 0; i < count; ++i)
      points.grid[axis][i] = payload.head().min[axis] + static_cast<std::int64_t>(drawn[i]);
  }
  points.levels.assign(payload.levelEnds().begin(), payload.levelEnds().end());

  const PointLayout& layout = info.layout;
  points.attributes.resize(count * layout.stride());
  for (std::size_t a = 0; a < layout.attributes().size(); ++a)
    if (layout.attributes()[a].name != attribute::kRgb)
      decodeAttribute(payload, static_cast<int>(a), layout.attributes()[a], layout.stride(),
                      points.attributes.data() + layout.offset(a));
  // Last, since a point's colour shift may be an attribute.
  if (const int rgb = layout.find(attribute::kRgb); rgb >= 0)
    decodeRgb(payload, info, layout.offset(static_cast<std::size_t>(rgb)), points.attributes);
  return points;
}

void readForDrawing(const Store& store, std::uint32_t nodeIndex, Precision precision, NodeData& out) {
  const NodeRecord& record = store.hierarchy().nodes[nodeIndex];
  std::vector<std::byte> bytes(drawBytes(record, precision));
  store.points().read(record.offset, bytes);
  decodeForDrawing(record, store.info(), bytes, precision, out);
}

NodePoints readAll(const Store& store, std::uint32_t nodeIndex) {
  const NodeRecord& record = store.hierarchy().nodes[nodeIndex];
  std::vector<std::byte> bytes(record.payloadBytes);
  store.points().read(record.offset, bytes);
  return decodeAll(record, store.info(), bytes);
}

}  // namespace strata
