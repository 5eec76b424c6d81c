#include "io/store/payload_reader.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "io/file/checksum.h"
#include "io/store/attribute_codec.h"
#include "io/store/bit_packing.h"
#include "io/store/colour_codec.h"

namespace strata {

PayloadReader::PayloadReader(const NodeRecord& record, const PayloadPart& part, DecodeScratch::Buffers& buffers)
    : record_(record),
      payload_(part.bytes),
      from_(part.from),
      parsed_(parseHead(record, part.head)),
      buffers_(buffers) {}

void PayloadReader::fail(const std::string& what) const {
  throw Error("points.bin", "node " + NodeKey{record_.key}.text() + ": " + what);
}

std::size_t PayloadReader::endOf(std::uint16_t id) const {
  std::size_t end = record_.headBytes;
  for (const PayloadPlane& p : parsed_.planes) {
    end += p.storedBytes;
    if (p.id == id) return end;
  }
  return 0;
}

std::size_t PayloadReader::wholeEnd() const {
  std::size_t end = record_.headBytes;
  for (const PayloadPlane& p : parsed_.planes) {
    if (end + p.storedBytes > from_ + payload_.size()) break;
    end += p.storedBytes;
  }
  return end;
}

bool PayloadReader::holds(std::uint16_t id) const {
  std::size_t begin = record_.headBytes;
  for (const PayloadPlane& p : parsed_.planes) {
    if (p.id == id) return p.storedBytes > 0 && begin >= from_ && begin + p.storedBytes <= from_ + payload_.size();
    begin += p.storedBytes;
  }
  return false;
}

PayloadReader::Plane PayloadReader::plane(std::uint16_t id) {
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
    buffers_.stored.resize(stored.size() + kBitSlack);
    std::copy(stored.begin(), stored.end(), buffers_.stored.begin());
    return {encoding, std::span(buffers_.stored).first(stored.size())};
  }
  fail("plane " + std::to_string(id) + " is missing");
}

std::span<const std::byte> PayloadReader::packedPositions(int plane) {
  const Plane found = this->plane(static_cast<std::uint16_t>(kPosition10 + plane));
  const std::size_t expected = packedBytes(pointCount(), planeWidths(head(), plane).sum());
  if (found.encoding != kPacked || found.stored.size() != expected) fail("positions do not decode");
  return found.stored;
}

void PayloadReader::openLeading() {
  if (levelEnds().empty()) {
    leadingIsOctree_ = false;
    leading_ = packedPositions(0);
    leadingFields_ = planeFields(head(), 0);
    return;
  }
  leadingIsOctree_ = true;
  const Plane found = plane(kPosition10);
  if (found.encoding != kOctree || !buffers_.octree.open(head(), levelEnds(), found.stored))
    fail("positions do not decode");
}

void PayloadReader::readLeading(std::size_t first, std::span<Lanes> out) {
  if (!leadingIsOctree_)
    leadingFields_.read(leading_.data(), first, out);
  else if (!buffers_.octree.read(first, out))
    fail("positions do not decode");
}

void PayloadReader::closeLeading() const {
  if (leadingIsOctree_ && !buffers_.octree.atEnd()) fail("positions do not decode");
}

template <class T>
void decodeComponent(PayloadReader& payload, const PayloadReader::Plane& plane, std::span<const std::byte>& rest,
                     std::span<T> drawn) {
  ComponentDecoder<T> decoder;
  if (plane.encoding != kColumns || !decoder.open(rest, drawn.size(), payload.buffers().spare))
    payload.fail("attribute does not decode");
  toDrawingOrder(payload.levelEnds(), drawn, [&](std::size_t, std::span<T> out) { decoder.read(out); });
}

namespace {

template <class T>
void decodeColumns(PayloadReader& payload, const PayloadReader::Plane& plane, const Attribute& attribute,
                   std::size_t stride, std::byte* first) {
  std::span<const std::byte> rest = plane.stored;
  std::vector<T> drawn(payload.pointCount());
  for (std::size_t c = 0; c < attribute.components; ++c) {
    decodeComponent(payload, plane, rest, std::span<T>(drawn));
    for (std::size_t i = 0; i < drawn.size(); ++i)
      std::memcpy(first + i * stride + c * sizeof(T), &drawn[i], sizeof(T));
  }
  if (!rest.empty()) payload.fail("attribute does not decode");
}

}  // namespace

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

void decodeDrawnColours(PayloadReader& payload, std::vector<std::uint32_t>& out) {
  const PayloadReader::Plane plane = payload.plane(kColour);
  ColourDecoder decoder;
  if (plane.encoding != kColumns || !decoder.open(plane.stored, payload.pointCount(), payload.buffers().spare))
    payload.fail("colours do not decode");
  out.resize(payload.pointCount());
  toDrawingOrder(payload.levelEnds(), std::span(out),
                 [&](std::size_t, std::span<std::uint32_t> colours) { decoder.read(colours); });
}

template void decodeComponent(PayloadReader&, const PayloadReader::Plane&, std::span<const std::byte>&,
                              std::span<std::uint8_t>);
template void decodeComponent(PayloadReader&, const PayloadReader::Plane&, std::span<const std::byte>&,
                              std::span<std::uint16_t>);

}  // namespace strata
