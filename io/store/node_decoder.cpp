#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

#include "core/error.h"
#include "core/octahedral.h"
#include "io/store/payload_reader.h"

namespace strata {

DecodeScratch::DecodeScratch() : buffers_(std::make_unique<Buffers>()) {}
DecodeScratch::~DecodeScratch() = default;
DecodeScratch::DecodeScratch(DecodeScratch&&) noexcept = default;

namespace {

/// The id of an attribute's plane; an id that no payload has when the layout has no such attribute.
std::uint16_t planeOf(const StoreInfo& info, std::string_view name) {
  const int index = info.layout.find(name);
  return index < 0 ? std::uint16_t{0xffff} : static_cast<std::uint16_t>(kFirstAttributePlane + index);
}

void decodePositions(PayloadReader& payload, int plane, std::vector<std::uint32_t>& out) {
  out.resize(payload.pointCount());
  if (plane == 0) {
    payload.openLeading();
    toDrawingOrder(payload.levelEnds(), std::span(out),
                   [&](std::size_t first, std::span<Lanes> lanes) { payload.readLeading(first, lanes); });
    return payload.closeLeading();
  }
  const std::byte* const stored = payload.packedPositions(plane).data();
  const LaneFields fields = planeFields(payload.head(), plane);
  toDrawingOrder(payload.levelEnds(), std::span(out),
                 [&](std::size_t first, std::span<Lanes> lanes) { fields.read(stored, first, lanes); });
}

/// Decodes an attribute of one component.
template <class T>
void decodeValues(PayloadReader& payload, std::uint16_t id, std::vector<T>& out) {
  const PayloadReader::Plane plane = payload.plane(id);
  if (plane.encoding == kConstant) {
    T value;
    if (plane.stored.size() != sizeof value) payload.fail("constant plane has the wrong size");
    std::memcpy(&value, plane.stored.data(), sizeof value);
    out.assign(payload.pointCount(), value);
    return;
  }
  std::span<const std::byte> rest = plane.stored;
  out.resize(payload.pointCount());
  decodeComponent(payload, plane, rest, std::span(out));
  if (!rest.empty()) payload.fail("attribute does not decode");
}

/// Gives all batches the box of the node. Each holds whole passes over the node, so its own box would hardly be
/// smaller.
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

/// Decodes normals that are stored as floats or as octahedral codes.
void decodeNormals(PayloadReader& payload, const StoreInfo& info, std::vector<std::uint32_t>& out) {
  const auto decode = [&](std::string_view name, auto& values) {
    const int index = info.layout.find(name);
    values.resize(payload.pointCount());
    decodeAttribute(payload, index, info.layout.attributes()[static_cast<std::size_t>(index)], sizeof values[0],
                    std::as_writable_bytes(std::span(values)).data());
    out.resize(values.size());
  };
  if (payload.holds(planeOf(info, attribute::kNormal))) {
    std::vector<glm::vec3> normals;
    decode(attribute::kNormal, normals);
    std::transform(normals.begin(), normals.end(), out.begin(), packNormal);
  } else if (payload.holds(planeOf(info, attribute::kNormalOctahedral))) {
    std::vector<Octahedral> codes;
    decode(attribute::kNormalOctahedral, codes);
    std::transform(codes.begin(), codes.end(), out.begin(),
                   [](const Octahedral& code) { return packNormal(decodeOctahedral(code)); });
  }
}

/// Throws unless the payload has the planes that every node of such a store has.
void requirePlanes(const PayloadReader& payload, const StoreInfo& info) {
  const auto require = [&payload](std::uint16_t id) {
    if (payload.endOf(id) == 0) payload.fail("plane " + std::to_string(id) + " is missing");
  };
  for (const std::uint16_t id : {kPosition10, kPosition20, kPosition30}) require(id);
  if (info.layout.find(attribute::kRgb) >= 0) require(kColour);
  for (const std::string_view name : {attribute::kIntensity, attribute::kClassification})
    if (info.layout.find(name) >= 0) require(planeOf(info, name));
}

PlaneEnds endsOf(const PayloadReader& payload, const StoreInfo& info) {
  const auto end = [&payload](std::uint16_t id) { return static_cast<std::uint32_t>(payload.endOf(id)); };
  PlaneEnds ends;
  ends.whole = static_cast<std::uint32_t>(payload.wholeEnd());
  for (int plane = 0; plane < 3; ++plane) ends.position[plane] = end(static_cast<std::uint16_t>(kPosition10 + plane));
  ends.colour = end(kColour);
  ends.intensity = end(planeOf(info, attribute::kIntensity));
  ends.classification = end(planeOf(info, attribute::kClassification));
  ends.returnNumber = end(planeOf(info, attribute::kReturnNumber));
  ends.normal = std::max(end(planeOf(info, attribute::kNormal)), end(planeOf(info, attribute::kNormalOctahedral)));
  return ends;
}

}  // namespace

std::uint32_t drawBytes(const NodeRecord& record, Precision precision) {
  return record.drawBytes[static_cast<int>(precision) - 1];
}

PlaneEnds decodeForDrawing(const NodeRecord& record, const StoreInfo& info, const PayloadPart& part,
                           DecodeScratch& scratch, NodeData& out) {
  PayloadReader payload(record, part, scratch.buffers());
  requirePlanes(payload, info);
  const PlaneEnds ends = endsOf(payload, info);
  const bool isFirst = part.from == 0;
  if (isFirst) {
    out.key = NodeKey{record.key};
    out.spacing = record.spacing;
    describeBatches(payload.head(), info, out);
    if (part.bytes.size() >= ends.position[0])
      decodePositions(payload, 0, out.position[0]);  // also a plane of no bytes
    else
      out.position[0].clear();
  }
  if (out.position[0].size() != payload.pointCount() && !isFirst) payload.fail("not the points that were read before");
  // Planes that are not in this part stay as a part before left them. Vectors keep their size, since growing one fills
  // it.
  const auto decode = [&](std::uint16_t id, auto& values, auto&& decodePlane) {
    if (payload.holds(id))
      decodePlane(values);
    else if (isFirst)
      values.clear();
  };
  for (int plane = 1; plane < 3; ++plane)
    decode(static_cast<std::uint16_t>(kPosition10 + plane), out.position[plane],
           [&](auto& values) { decodePositions(payload, plane, values); });
  decode(kColour, out.colour, [&](auto& values) { decodeDrawnColours(payload, values); });
  const auto decodeOne = [&](std::string_view name, auto& values) {
    const std::uint16_t id = planeOf(info, name);
    decode(id, values, [&](auto& all) { decodeValues(payload, id, all); });
  };
  decodeOne(attribute::kIntensity, out.intensity);
  decodeOne(attribute::kClassification, out.classification);
  decodeOne(attribute::kReturnNumber, out.returnNumber);
  if (isFirst) out.normal.clear();
  decodeNormals(payload, info, out.normal);
  return ends;
}

void decodeForDrawing(const NodeRecord& record, const StoreInfo& info, std::span<const std::byte> payload,
                      Precision precision, NodeData& out) {
  DecodeScratch scratch;
  const PlaneEnds ends = decodeForDrawing(record, info, {payload, 0, payload}, scratch, out);
  for (int plane = 0; plane < static_cast<int>(precision); ++plane) {
    if (payload.size() < ends.position[plane])
      throw Error("points.bin", "node " + NodeKey{record.key}.text() + ": truncated plane");
    out.position[plane].resize(record.pointCount, 0u);
  }
}

void readForDrawing(const Store& store, std::uint32_t nodeIndex, Precision precision, NodeData& out) {
  const NodeRecord& record = store.hierarchy().nodes[nodeIndex];
  std::vector<std::byte> bytes(drawBytes(record, precision));
  store.points().read(record.offset, bytes);
  decodeForDrawing(record, store.info(), bytes, precision, out);
}

}  // namespace strata
