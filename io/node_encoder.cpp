#include <lz4.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/error.h"
#include "io/bit_packing.h"
#include "io/node_codec.h"
#include "io/node_payload.h"

namespace strata {
namespace {

/// Collects planes and their directory in order of need.
class PayloadWriter {
 public:
  void addPlane(std::uint16_t id, std::span<const std::byte> raw, std::size_t elementBytes) {
    if (raw.size() > LZ4_MAX_INPUT_SIZE) throw Error("points.bin", "a node has too many points for one plane");
    PayloadPlane plane{};
    plane.id = id;
    plane.rawBytes = static_cast<std::uint32_t>(raw.size());
    const std::size_t start = body_.size();
    if (isConstant(raw, elementBytes)) {
      plane.encoding = kConstant;
      for (std::size_t b = 0; b < elementBytes; ++b) body_.push_back(raw[b * (raw.size() / elementBytes)]);
    } else {
      plane.encoding = kLz4;
      body_.resize(start + static_cast<std::size_t>(LZ4_compressBound(static_cast<int>(raw.size()))));
      const int packed =
          LZ4_compress_default(reinterpret_cast<const char*>(raw.data()), reinterpret_cast<char*>(body_.data() + start),
                               static_cast<int>(raw.size()), static_cast<int>(body_.size() - start));
      body_.resize(start + static_cast<std::size_t>(packed));
      if (static_cast<std::size_t>(packed) >= raw.size()) {
        plane.encoding = kRaw;
        body_.resize(start);
        body_.insert(body_.end(), raw.begin(), raw.end());
      }
    }
    plane.storedBytes = static_cast<std::uint32_t>(body_.size() - start);
    plane.checksum = XXH3_64bits(body_.data() + start, plane.storedBytes);
    planes_.push_back(plane);
  }
  std::uint32_t bodyBytes() const { return static_cast<std::uint32_t>(body_.size()); }
  const std::vector<PayloadPlane>& planes() const { return planes_; }
  const std::vector<std::byte>& body() const { return body_; }

 private:
  /// Position planes (elementBytes 0) are never constant: their bits run on.
  static bool isConstant(std::span<const std::byte> raw, std::size_t elementBytes) {
    if (elementBytes == 0 || raw.empty()) return false;
    const std::size_t count = raw.size() / elementBytes;
    for (std::size_t b = 0; b < elementBytes; ++b) {
      const std::byte* column = raw.data() + b * count;
      if (count > 1 && std::memcmp(column, column + 1, count - 1) != 0) return false;
    }
    return true;
  }

  std::vector<PayloadPlane> planes_;
  std::vector<std::byte> body_;
};

std::vector<PayloadBatch> makeBatches(const NodePoints& points) {
  std::vector<PayloadBatch> batches;
  for (std::size_t first = 0; first < points.count(); first += Batch::kMaxPoints) {
    const std::size_t end = std::min(points.count(), first + Batch::kMaxPoints);
    PayloadBatch batch{};
    batch.pointCount = static_cast<std::uint32_t>(end - first);
    for (int axis = 0; axis < 3; ++axis) {
      const auto begin = points.grid[axis].begin();
      const auto [low, high] =
          std::minmax_element(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(end));
      batch.min[axis] = *low;
      batch.bits[axis] = static_cast<std::uint8_t>(std::bit_width(static_cast<std::uint64_t>(*high - *low)));
    }
    batches.push_back(batch);
  }
  return batches;
}

std::vector<std::byte> packPositions(const NodePoints& points, const std::vector<PayloadBatch>& batches, int plane) {
  std::vector<std::byte> raw;
  raw.reserve(points.count() * 4);
  BitWriter writer(raw);
  std::size_t first = 0;
  for (const PayloadBatch& batch : batches) {
    int width[3], shift[3];
    for (int axis = 0; axis < 3; ++axis) {
      const int bits = batch.bits[axis];
      width[axis] = planeBits(bits, plane);
      int below = bits - width[axis];
      if (plane > 0) below -= planeBits(bits, 0);
      if (plane > 1) below -= planeBits(bits, 1);
      shift[axis] = below;
    }
    for (std::size_t i = first; i < first + batch.pointCount; ++i)
      for (int axis = 0; axis < 3; ++axis) {
        const auto offset = static_cast<std::uint64_t>(points.grid[axis][i] - batch.min[axis]);
        writer.put(offset >> shift[axis] & ((std::uint64_t{1} << width[axis]) - 1), width[axis]);
      }
    writer.flush();
    first += batch.pointCount;
  }
  return raw;
}

/// Byte-planar copy of `bytes` bytes of every record from `offset` on.
std::vector<std::byte> gatherColumns(const NodePoints& points, std::size_t stride, std::size_t offset,
                                     std::size_t bytes) {
  const std::size_t count = points.count();
  std::vector<std::byte> raw(count * bytes);
  for (std::size_t b = 0; b < bytes; ++b) {
    const std::byte* from = points.attributes.data() + offset + b;
    std::byte* to = raw.data() + b * count;
    for (std::size_t i = 0; i < count; ++i) to[i] = from[i * stride];
  }
  return raw;
}

struct ColourPlanes {
  std::vector<std::byte> colour, residual;
};

ColourPlanes splitColour(const NodePoints& points, const StoreInfo& info, std::size_t offset) {
  const std::size_t count = points.count();
  const std::size_t stride = info.layout.stride();
  const int ownShift = info.layout.find(attribute::kColourShift);
  ColourPlanes planes{std::vector<std::byte>(count * 3), std::vector<std::byte>(count * 6)};
  for (std::size_t i = 0; i < count; ++i) {
    std::uint16_t rgb[3];
    std::memcpy(rgb, points.attributes.data() + i * stride + offset, sizeof rgb);
    const int shift =
        ownShift < 0
            ? info.colourShift
            : static_cast<int>(points.attributes[i * stride + info.layout.offset(static_cast<std::size_t>(ownShift))]);
    for (std::size_t c = 0; c < 3; ++c) {
      const unsigned shown = std::min(static_cast<unsigned>(rgb[c]) >> shift, 255u);
      const unsigned rest = rgb[c] - (shown << shift);
      planes.colour[c * count + i] = static_cast<std::byte>(shown);
      planes.residual[2 * c * count + i] = static_cast<std::byte>(rest & 255);
      planes.residual[(2 * c + 1) * count + i] = static_cast<std::byte>(rest >> 8);
    }
  }
  return planes;
}

}  // namespace

EncodedNode encodeNode(const NodePoints& points, const StoreInfo& info) {
  const PointLayout& layout = info.layout;
  const std::vector<PayloadBatch> batches = makeBatches(points);
  const int rgb = layout.find(attribute::kRgb);
  PayloadWriter writer;
  std::uint32_t drawEnd[3];
  const auto addAttribute = [&](int index) {
    const Attribute& a = layout.attributes()[static_cast<std::size_t>(index)];
    writer.addPlane(static_cast<std::uint16_t>(kFirstAttributePlane + index),
                    gatherColumns(points, layout.stride(), layout.offset(static_cast<std::size_t>(index)), a.bytes()),
                    a.bytes());
  };

  writer.addPlane(kPosition10, packPositions(points, batches, 0), 0);
  std::vector<std::byte> residual;
  if (rgb >= 0) {
    ColourPlanes colour = splitColour(points, info, layout.offset(static_cast<std::size_t>(rgb)));
    writer.addPlane(kColour, colour.colour, 3);
    residual = std::move(colour.residual);
  }
  const int intensity = layout.find(attribute::kIntensity);
  const int classification = layout.find(attribute::kClassification);
  if (intensity >= 0) addAttribute(intensity);
  if (classification >= 0) addAttribute(classification);
  drawEnd[0] = writer.bodyBytes();
  writer.addPlane(kPosition20, packPositions(points, batches, 1), 0);
  drawEnd[1] = writer.bodyBytes();
  writer.addPlane(kPosition30, packPositions(points, batches, 2), 0);
  drawEnd[2] = writer.bodyBytes();
  if (rgb >= 0) writer.addPlane(kColourResidual, residual, 6);
  for (int i = 0; i < static_cast<int>(layout.attributes().size()); ++i)
    if (i != rgb && i != intensity && i != classification) addAttribute(i);

  const PayloadHead head{static_cast<std::uint32_t>(points.count()), static_cast<std::uint16_t>(batches.size()),
                         static_cast<std::uint16_t>(writer.planes().size())};
  const std::size_t batchBytes = batches.size() * sizeof(PayloadBatch);
  const std::size_t planeBytes = writer.planes().size() * sizeof(PayloadPlane);
  EncodedNode node;
  node.headBytes = static_cast<std::uint32_t>(sizeof head + batchBytes + planeBytes);
  node.payload.resize(node.headBytes + writer.body().size());
  std::byte* to = node.payload.data();
  std::memcpy(to, &head, sizeof head);
  if (batchBytes > 0) std::memcpy(to + sizeof head, batches.data(), batchBytes);
  std::memcpy(to + sizeof head + batchBytes, writer.planes().data(), planeBytes);
  node.headChecksum = XXH3_64bits(to, node.headBytes);
  if (!writer.body().empty()) std::memcpy(to + node.headBytes, writer.body().data(), writer.body().size());
  for (int p = 0; p < 3; ++p) node.drawBytes[p] = node.headBytes + drawEnd[p];
  return node;
}

}  // namespace strata
