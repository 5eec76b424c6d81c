#include <lz4.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "io/bit_packing.h"
#include "io/node_codec.h"
#include "io/node_payload.h"

namespace strata {
namespace {

/// The parts of one payload, every length checked against the record and against each other.
class PayloadReader {
 public:
  PayloadReader(const NodeRecord& record, std::span<const std::byte> payload) : record_(record), payload_(payload) {
    if (payload.size() < record.headBytes || record.headBytes < sizeof(PayloadHead)) fail("truncated payload head");
    if (XXH3_64bits(payload.data(), record.headBytes) != record.headChecksum) fail("payload head checksum mismatch");
    PayloadHead head;
    std::memcpy(&head, payload.data(), sizeof head);
    const std::size_t expected =
        sizeof head + head.batchCount * sizeof(PayloadBatch) + head.planeCount * sizeof(PayloadPlane);
    if (expected != record.headBytes) fail("payload head has the wrong size");
    batches_.resize(head.batchCount);
    planes_.resize(head.planeCount);
    if (!batches_.empty())
      std::memcpy(batches_.data(), payload.data() + sizeof head, batches_.size() * sizeof(PayloadBatch));
    if (!planes_.empty())
      std::memcpy(planes_.data(), payload.data() + sizeof head + batches_.size() * sizeof(PayloadBatch),
                  planes_.size() * sizeof(PayloadPlane));
    checkBatches(head.pointCount);
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error("points.bin", "node " + NodeKey{record_.key}.text() + ": " + what);
  }
  const std::vector<PayloadBatch>& batches() const { return batches_; }
  std::size_t pointCount() const { return record_.pointCount; }
  bool has(std::uint16_t id) const {
    return std::any_of(planes_.begin(), planes_.end(), [id](const PayloadPlane& p) { return p.id == id; });
  }

  /// False as well where the bytes at hand end before the plane does.
  bool holds(std::uint16_t id) const {
    std::size_t end = record_.headBytes;
    for (const PayloadPlane& p : planes_) {
      end += p.storedBytes;
      if (p.id == id) return end <= payload_.size();
    }
    return false;
  }

  /// The decoded bytes of a plane, with 8 readable bytes behind them; valid until the next call.
  std::span<const std::byte> plane(std::uint16_t id, std::size_t rawBytes, std::size_t elementBytes) {
    std::size_t offset = record_.headBytes;
    for (const PayloadPlane& p : planes_) {
      if (p.id == id) return decode(p, offset, rawBytes, elementBytes);
      offset += p.storedBytes;
    }
    fail("plane " + std::to_string(id) + " is missing");
  }

 private:
  void checkBatches(std::uint32_t headCount) const {
    std::uint64_t points = 0;
    for (const PayloadBatch& batch : batches_) {
      if (batch.pointCount == 0 || batch.pointCount > Batch::kMaxPoints) fail("batch with a wrong number of points");
      for (const std::uint8_t bits : batch.bits)
        if (bits > kMaxCoordinateBits) fail("batch with too many bits");
      points += batch.pointCount;
    }
    if (points != record_.pointCount || headCount != record_.pointCount)
      fail("point count does not match, found " + std::to_string(points) + " (expected " +
           std::to_string(record_.pointCount) + ")");
  }

  std::span<const std::byte> decode(const PayloadPlane& p, std::size_t offset, std::size_t rawBytes,
                                    std::size_t elementBytes) {
    if (offset > payload_.size() || p.storedBytes > payload_.size() - offset) fail("truncated plane");
    const std::span<const std::byte> stored = payload_.subspan(offset, p.storedBytes);
    if (XXH3_64bits(stored.data(), stored.size()) != p.checksum) fail("block checksum mismatch");
    if (p.rawBytes != rawBytes) fail("plane has the wrong size");
    raw_.resize(rawBytes + 8);
    std::memset(raw_.data() + rawBytes, 0, 8);
    switch (p.encoding) {
      case kConstant: {
        if (elementBytes == 0 || stored.size() != elementBytes) fail("constant plane has the wrong size");
        const std::size_t count = rawBytes / elementBytes;
        for (std::size_t b = 0; b < elementBytes; ++b)
          std::memset(raw_.data() + b * count, static_cast<int>(stored[b]), count);
        break;
      }
      case kRaw:
        if (stored.size() != rawBytes) fail("raw plane has the wrong size");
        if (rawBytes > 0) std::memcpy(raw_.data(), stored.data(), rawBytes);
        break;
      case kLz4:
        if (LZ4_decompress_safe(reinterpret_cast<const char*>(stored.data()), reinterpret_cast<char*>(raw_.data()),
                                static_cast<int>(stored.size()),
                                static_cast<int>(rawBytes)) != static_cast<int>(rawBytes))
          fail("block does not decompress");
        break;
      default:
        fail("plane with an unknown encoding");
    }
    return {raw_.data(), rawBytes};
  }

  const NodeRecord& record_;
  std::span<const std::byte> payload_;
  std::vector<PayloadBatch> batches_;
  std::vector<PayloadPlane> planes_;
  std::vector<std::byte> raw_;
};

std::size_t positionBytes(const std::vector<PayloadBatch>& batches, int plane) {
  std::uint64_t total = 0;
  for (const PayloadBatch& batch : batches) total += packedBytes(batch, plane);
  return static_cast<std::size_t>(total);
}

/// Where the 10 bits of a plane stand in its packed field: shown = (field << left) >> right.
struct DrawShift {
  int left = 0, right = 0;
};
DrawShift drawShift(int bits, int plane) {
  if (plane < 2) return {std::max(0, 10 - std::max(0, bits - 10 * plane)), 0};
  return bits <= 30 ? DrawShift{30 - std::max(bits, 20), 0} : DrawShift{0, bits - 30};
}

void unpackForDrawing(PayloadReader& payload, int plane, std::vector<std::uint32_t>& out) {
  const std::span<const std::byte> raw =
      payload.plane(static_cast<std::uint16_t>(kPosition10 + plane), positionBytes(payload.batches(), plane), 0);
  out.resize(payload.pointCount());
  const std::byte* data = raw.data();
  std::size_t i = 0;
  for (const PayloadBatch& batch : payload.batches()) {
    BitReader reader(data);
    int width[3];
    DrawShift shift[3];
    for (int axis = 0; axis < 3; ++axis) {
      width[axis] = planeBits(batch.bits[axis], plane);
      shift[axis] = drawShift(batch.bits[axis], plane);
    }
    for (const std::size_t end = i + batch.pointCount; i < end; ++i) {
      std::uint64_t packed = 0;
      for (int axis = 0; axis < 3; ++axis)
        packed |= (reader.get(width[axis]) << shift[axis].left >> shift[axis].right) << (10 * axis);
      out[i] = static_cast<std::uint32_t>(packed);
    }
    data += packedBytes(batch, plane);
  }
}

void addPositions(PayloadReader& payload, int plane, NodePoints& points) {
  const std::span<const std::byte> raw =
      payload.plane(static_cast<std::uint16_t>(kPosition10 + plane), positionBytes(payload.batches(), plane), 0);
  const std::byte* data = raw.data();
  std::size_t i = 0;
  for (const PayloadBatch& batch : payload.batches()) {
    BitReader reader(data);
    int width[3];
    for (int axis = 0; axis < 3; ++axis) width[axis] = planeBits(batch.bits[axis], plane);
    for (const std::size_t end = i + batch.pointCount; i < end; ++i)
      for (int axis = 0; axis < 3; ++axis)
        points.grid[axis][i] = points.grid[axis][i] << width[axis] | static_cast<std::int64_t>(reader.get(width[axis]));
    data += packedBytes(batch, plane);
  }
}

void scatterColumns(std::span<const std::byte> raw, std::size_t stride, std::size_t offset, std::size_t bytes,
                    NodePoints& points) {
  const std::size_t count = points.count();
  for (std::size_t b = 0; b < bytes; ++b)
    for (std::size_t i = 0; i < count; ++i) points.attributes[i * stride + offset + b] = raw[b * count + i];
}

void decodeColour(PayloadReader& payload, const StoreInfo& info, std::size_t offset, NodePoints& points) {
  const std::size_t count = points.count();
  const std::size_t stride = info.layout.stride();
  const auto value = [&](std::size_t i, std::size_t channel) {
    return points.attributes.data() + i * stride + offset + 2 * channel;
  };
  const int ownShift = info.layout.find(attribute::kColourShift);
  const auto shift = [&](std::size_t i) {
    if (ownShift < 0) return info.colourShift;
    return static_cast<int>(points.attributes[i * stride + info.layout.offset(static_cast<std::size_t>(ownShift))]) &
           15;
  };
  std::span<const std::byte> raw = payload.plane(kColour, count * 3, 3);
  for (std::size_t channel = 0; channel < 3; ++channel)
    for (std::size_t i = 0; i < count; ++i) {
      const auto shown = static_cast<std::uint16_t>(static_cast<unsigned>(raw[channel * count + i]) << shift(i));
      std::memcpy(value(i, channel), &shown, sizeof shown);
    }
  raw = payload.plane(kColourResidual, count * 6, 6);
  for (std::size_t channel = 0; channel < 3; ++channel)
    for (std::size_t i = 0; i < count; ++i) {
      std::uint16_t sum;
      std::memcpy(&sum, value(i, channel), sizeof sum);
      sum = static_cast<std::uint16_t>(sum + static_cast<unsigned>(raw[2 * channel * count + i]) +
                                       (static_cast<unsigned>(raw[(2 * channel + 1) * count + i]) << 8));
      std::memcpy(value(i, channel), &sum, sizeof sum);
    }
}

void describeBatches(const std::vector<PayloadBatch>& batches, const StoreInfo& info, NodeData& out) {
  const Box cube = nodeCube(out.key, info.rootCube());
  out.origin = cube.min;
  out.batches.clear();
  std::uint32_t first = 0;
  for (const PayloadBatch& stored : batches) {
    Batch batch;
    batch.firstPoint = first;
    batch.pointCount = stored.pointCount;
    for (int axis = 0; axis < 3; ++axis) {
      const double corner = std::round((cube.min[axis] - info.grid.offset[axis]) / info.grid.scale[axis]);
      batch.boxMin[axis] = (static_cast<double>(stored.min[axis]) - corner) * info.grid.scale[axis];
      batch.boxSize[axis] = std::ldexp(info.grid.scale[axis], stored.bits[axis]);
      batch.bits[axis] = stored.bits[axis];
    }
    out.batches.push_back(batch);
    first += stored.pointCount;
  }
}

/// What only some ways of drawing look at, where the bytes at hand hold it.
void decodeShown(PayloadReader& payload, const StoreInfo& info, NodeData& out) {
  const std::size_t count = payload.pointCount();
  out.returnNumber.clear();
  out.normal.clear();
  const auto planeOf = [&](std::string_view name) {
    return static_cast<std::uint16_t>(kFirstAttributePlane + std::max(info.layout.find(name), 0));
  };
  if (info.layout.find(attribute::kReturnNumber) >= 0 && payload.holds(planeOf(attribute::kReturnNumber))) {
    const auto raw = payload.plane(planeOf(attribute::kReturnNumber), count, 1);
    out.returnNumber.resize(count);
    std::memcpy(out.returnNumber.data(), raw.data(), count);
  }
  if (info.layout.find(attribute::kNormal) >= 0 && payload.holds(planeOf(attribute::kNormal))) {
    const auto raw = payload.plane(planeOf(attribute::kNormal), count * 12, 12);
    out.normal.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      std::byte bytes[12];
      for (std::size_t b = 0; b < 12; ++b) bytes[b] = raw[b * count + i];
      float xyz[3];
      std::memcpy(xyz, bytes, sizeof xyz);
      out.normal[i] = packNormal({xyz[0], xyz[1], xyz[2]});
    }
  }
}

}  // namespace

std::uint32_t drawBytes(const NodeRecord& record, Precision precision) {
  return record.drawBytes[static_cast<int>(precision) - 1];
}

void decodeForDrawing(const NodeRecord& record, const StoreInfo& info, std::span<const std::byte> bytes,
                      Precision precision, NodeData& out) {
  PayloadReader payload(record, bytes);
  const std::size_t count = payload.pointCount();
  out.key = NodeKey{record.key};
  describeBatches(payload.batches(), info, out);
  for (int plane = 0; plane < 3; ++plane) {
    if (plane < static_cast<int>(precision))
      unpackForDrawing(payload, plane, out.position[plane]);
    else
      out.position[plane].clear();
  }
  out.colour.clear();
  out.intensity.clear();
  out.classification.clear();
  if (payload.has(kColour)) {
    const std::span<const std::byte> raw = payload.plane(kColour, count * 3, 3);
    out.colour.resize(count);
    for (std::size_t i = 0; i < count; ++i)
      out.colour[i] = static_cast<std::uint32_t>(raw[i]) | static_cast<std::uint32_t>(raw[count + i]) << 8 |
                      static_cast<std::uint32_t>(raw[2 * count + i]) << 16 | 0xff000000u;
  }
  if (const int index = info.layout.find(attribute::kIntensity); index >= 0) {
    const auto raw = payload.plane(static_cast<std::uint16_t>(kFirstAttributePlane + index), count * 2, 2);
    out.intensity.resize(count);
    for (std::size_t i = 0; i < count; ++i)
      out.intensity[i] =
          static_cast<std::uint16_t>(static_cast<unsigned>(raw[i]) | static_cast<unsigned>(raw[count + i]) << 8);
  }
  if (const int index = info.layout.find(attribute::kClassification); index >= 0) {
    const auto raw = payload.plane(static_cast<std::uint16_t>(kFirstAttributePlane + index), count, 1);
    out.classification.resize(count);
    std::memcpy(out.classification.data(), raw.data(), count);
  }
  decodeShown(payload, info, out);
}

NodePoints decodeAll(const NodeRecord& record, const StoreInfo& info, std::span<const std::byte> bytes) {
  PayloadReader payload(record, bytes);
  const std::size_t count = payload.pointCount();
  NodePoints points;
  for (auto& axis : points.grid) axis.assign(count, 0);
  points.attributes.resize(count * info.layout.stride());
  for (int plane = 0; plane < 3; ++plane) addPositions(payload, plane, points);
  std::size_t i = 0;
  for (const PayloadBatch& batch : payload.batches())
    for (const std::size_t end = i + batch.pointCount; i < end; ++i)
      for (int axis = 0; axis < 3; ++axis) points.grid[axis][i] += batch.min[axis];

  const PointLayout& layout = info.layout;
  for (std::size_t a = 0; a < layout.attributes().size(); ++a) {
    const Attribute& column = layout.attributes()[a];
    if (column.name == attribute::kRgb) continue;
    const auto raw =
        payload.plane(static_cast<std::uint16_t>(kFirstAttributePlane + a), count * column.bytes(), column.bytes());
    scatterColumns(raw, layout.stride(), layout.offset(a), column.bytes(), points);
  }
  // Last, since a point's colour shift may be an attribute.
  if (const int rgb = layout.find(attribute::kRgb); rgb >= 0)
    decodeColour(payload, info, layout.offset(static_cast<std::size_t>(rgb)), points);
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
