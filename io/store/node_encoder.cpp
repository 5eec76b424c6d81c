#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "io/file/checksum.h"
#include "io/store/attribute_codec.h"
#include "io/store/bit_packing.h"
#include "io/store/colour_codec.h"
#include "io/store/node_codec.h"
#include "io/store/node_payload.h"
#include "io/store/point_order.h"
#include "io/store/position_codec.h"

namespace strata {

struct EncodeScratch::Buffers {
  std::vector<std::uint32_t> levelEnds;
  PointOrder order;
  OctreeEncoder octree;
  std::vector<int> depths;
  std::vector<std::byte> body;
  std::vector<PayloadPlane> planes;
  std::vector<std::uint8_t> spare;
  std::vector<std::uint32_t> colours;
  std::vector<std::uint16_t> residuals;
  std::vector<std::uint64_t> differing;
};

EncodeScratch::EncodeScratch() : buffers_(std::make_unique<Buffers>()) {}
EncodeScratch::~EncodeScratch() = default;
EncodeScratch::EncodeScratch(EncodeScratch&&) noexcept = default;

namespace {

using Buffers = EncodeScratch::Buffers;

/// The memory for more points than this is given back at once.
constexpr std::size_t kPointsToRemember = 1u << 18;

/// Bounds, and the octree level where each axis starts to be halved: the longest at 0, so that cells are nearly cubes.
PayloadHead describe(const NodePoints& points, const StoreInfo& info) {
  PayloadHead head{};
  head.pointCount = static_cast<std::uint32_t>(points.count());
  double sides[3] = {0.0, 0.0, 0.0};  // log2 of metres
  for (int axis = 0; axis < 3; ++axis) {
    if (points.count() > 0) {
      const auto [low, high] = std::minmax_element(points.grid[axis].begin(), points.grid[axis].end());
      head.min[axis] = *low;
      head.bits[axis] = static_cast<std::uint8_t>(std::bit_width(static_cast<std::uint64_t>(*high - *low)));
    }
    sides[axis] = head.bits[axis] + std::log2(info.grid.scale[axis]);
  }
  const double longest = std::max({sides[0], sides[1], sides[2]});
  for (int axis = 0; axis < 3; ++axis)
    head.start[axis] = static_cast<std::uint8_t>(std::min(std::round(longest - sides[axis]), double{kOctreeLevels}));
  return head;
}

/// Encodes one node into the scratch's body and directory.
class NodeWriter {
 public:
  NodeWriter(const NodePoints& points, const StoreInfo& info, Buffers& buffers)
      : points_(points), info_(info), buffers_(buffers), head_(describe(points, info)) {
    buffers.body.clear();
    buffers.planes.clear();
    buffers.levelEnds.clear();
    for (const std::uint32_t end : points.levels)
      if (end > (buffers.levelEnds.empty() ? 0 : buffers.levelEnds.back())) buffers.levelEnds.push_back(end);
    if (!buffers.levelEnds.empty() && buffers.levelEnds.back() != points.count())
      throw Error("points.bin", "levels of a node do not end at its point count");
    head_.levelCount = static_cast<std::uint16_t>(buffers.levelEnds.size());
    buffers.order.index.clear();
    if (head_.levelCount > 0) sortLevels(points, head_, buffers.levelEnds, buffers.order);
    findConstants();
  }

  EncodedNode encode() {
    const PointLayout& layout = info_.layout;
    const int rgb = layout.find(attribute::kRgb);
    const int intensity = layout.find(attribute::kIntensity);
    const int classification = layout.find(attribute::kClassification);
    std::size_t drawEnd[3];
    addLeadingPositions();
    if (rgb >= 0) addColours(layout.offset(static_cast<std::size_t>(rgb)));
    if (intensity >= 0) addAttribute(intensity);
    if (classification >= 0) addAttribute(classification);
    drawEnd[0] = buffers_.body.size();
    addPackedPositions(1);
    drawEnd[1] = buffers_.body.size();
    addPackedPositions(2);
    drawEnd[2] = buffers_.body.size();
    if (rgb >= 0) addResiduals();
    for (int i = 0; i < static_cast<int>(layout.attributes().size()); ++i)
      if (i != rgb && i != intensity && i != classification) addAttribute(i);
    return assemble(drawEnd);
  }

 private:
  std::size_t count() const { return points_.count(); }
  const std::vector<std::uint32_t>& index() const { return buffers_.order.index; }
  std::size_t source(std::size_t stored) const { return index().empty() ? stored : index()[stored]; }

  void finishPlane(std::uint16_t id, PlaneEncoding encoding, std::size_t start) {
    const std::vector<std::byte>& body = buffers_.body;
    PayloadPlane plane{};
    plane.id = id;
    plane.encoding = encoding;
    plane.storedBytes = static_cast<std::uint32_t>(body.size() - start);
    plane.checksum = checksum(std::span(body).subspan(start));
    buffers_.planes.push_back(plane);
  }

  /// Which bytes of the records differ between points at all: one pass over the records, eight bytes at a time.
  void findConstants() {
    const std::size_t stride = info_.layout.stride();
    buffers_.differing.assign(stride / 8 + 1, 0);
    if (count() == 0 || stride == 0) return;
    const std::byte* const first = points_.attributes.data();
    const std::size_t words = stride / 8, tail = stride % 8;
    for (std::size_t i = 1; i < count(); ++i) {
      const std::byte* record = first + i * stride;
      for (std::size_t w = 0; w < words; ++w) {
        std::uint64_t a, b;
        std::memcpy(&a, first + 8 * w, 8);
        std::memcpy(&b, record + 8 * w, 8);
        buffers_.differing[w] |= a ^ b;
      }
      for (std::size_t t = 0; t < tail; ++t)
        buffers_.differing[words] |= static_cast<std::uint64_t>(first[8 * words + t] ^ record[8 * words + t])
                                     << (8 * t);
    }
  }
  bool isConstant(std::size_t offset, std::size_t bytes) const {
    for (std::size_t at = offset; at < offset + bytes; ++at)
      if ((buffers_.differing[at / 8] >> (8 * (at % 8)) & 255u) != 0) return false;
    return true;
  }

  /// Bit fields of points `first` to `end` in stored order: `width` bits of each axis, those above `shift`.
  void appendFields(std::size_t first, std::size_t end, const int (&width)[3], const int (&shift)[3]) {
    const int sum = width[0] + width[1] + width[2];
    const std::size_t bytes = packedBytes(end - first, sum);
    const std::size_t start = buffers_.body.size();
    buffers_.body.resize(start + bytes + kBitSlack);
    BitWriter writer(buffers_.body.data() + start);
    std::uint64_t mask[3];
    for (int axis = 0; axis < 3; ++axis) mask[axis] = (std::uint64_t{1} << width[axis]) - 1;
    const bool narrow = sum <= 57;
    for (std::size_t i = first; i < end && sum > 0; ++i) {
      const std::size_t from = source(i);
      std::uint64_t field[3];
      for (int axis = 0; axis < 3; ++axis)
        field[axis] =
            static_cast<std::uint64_t>(points_.grid[axis][from] - head_.min[axis]) >> shift[axis] & mask[axis];
      if (narrow) {
        writer.put(field[0] | field[1] << width[0] | field[2] << (width[0] + width[1]), sum);
      } else {
        for (int axis = 0; axis < 3; ++axis) writer.put(field[axis], width[axis]);
      }
    }
    writer.finish();
    buffers_.body.resize(start + bytes);
  }

  void addPackedPositions(int plane) {
    const std::size_t start = buffers_.body.size();
    const FieldWidths widths = planeWidths(head_, plane);
    int shift[3];
    for (int axis = 0; axis < 3; ++axis) {
      shift[axis] = 0;
      for (int below = plane + 1; below < 3; ++below) shift[axis] += planeBits(head_.bits[axis], below);
    }
    appendFields(0, count(), widths.axis, shift);
    finishPlane(static_cast<std::uint16_t>(kPosition10 + plane), kPacked, start);
  }

  void addLeadingPositions() {
    if (head_.levelCount == 0) return addPackedPositions(0);
    const std::size_t start = buffers_.body.size();
    buffers_.octree.clear();
    buffers_.depths.clear();
    std::size_t first = 0;
    for (const std::uint32_t end : buffers_.levelEnds) {
      buffers_.depths.push_back(
          buffers_.octree.addLevel(head_, std::span(buffers_.order.keys).subspan(first, end - first)));
      first = end;
    }
    buffers_.octree.append(buffers_.body);
    first = 0;
    for (std::size_t level = 0; level < buffers_.levelEnds.size(); ++level) {
      int width[3], shift[3];
      for (int axis = 0; axis < 3; ++axis) {
        const int bits = planeBits(head_.bits[axis], 0);
        width[axis] = bits - octreeBits(head_, axis, buffers_.depths[level]);
        shift[axis] = head_.bits[axis] - bits;
      }
      appendFields(first, buffers_.levelEnds[level], width, shift);
      first = buffers_.levelEnds[level];
    }
    finishPlane(kPosition10, kOctree, start);
  }

  void addColours(std::size_t offset) {
    const std::size_t stride = info_.layout.stride();
    const int ownShift = info_.layout.find(attribute::kColourShift);
    const std::size_t shiftAt = ownShift < 0 ? 0 : info_.layout.offset(static_cast<std::size_t>(ownShift));
    std::vector<std::uint32_t>& colours = buffers_.colours;
    colours.resize(count());
    std::uint32_t unequal = 0, lower = 0;
    for (std::size_t i = 0; i < count(); ++i) {
      const std::size_t from = source(i);
      const std::byte* record = points_.attributes.data() + from * stride;
      std::uint16_t rgb[3];
      std::memcpy(rgb, record + offset, sizeof rgb);
      const int shift = ownShift < 0 ? info_.colourShift : static_cast<int>(record[shiftAt]) & 15;
      std::uint32_t colour = 0;
      for (int c = 0; c < 3; ++c) {
        const std::uint32_t value = rgb[c];
        colour |= std::min(value >> shift, 255u) << (8 * c);
        unequal |= (value >> 8) ^ (value & 255u);
        lower |= value & 255u;
      }
      colours[i] = points_.drawColours.empty() ? colour : points_.drawColours[from] & 0xffffffu;
    }
    unit_ = ResidualUnit::shifted;
    if (ownShift < 0 && info_.colourShift == 8)
      unit_ = unequal == 0 ? ResidualUnit::repeated : lower == 0 ? ResidualUnit::upper : ResidualUnit::shifted;
    const std::size_t start = buffers_.body.size();
    appendColours(colours, buffers_.spare, buffers_.body);
    finishPlane(kColour, kColumns, start);

    // What an 8-bit source draws is all it has.
    if (unit_ == ResidualUnit::shifted || !points_.drawColours.empty())
      gatherResiduals(offset, ownShift < 0 ? -1 : static_cast<int>(shiftAt));
    else
      buffers_.residuals.clear();
  }

  /// `shiftAt` is where a record has its own colour shift, or -1.
  void gatherResiduals(std::size_t offset, int shiftAt) {
    const std::size_t stride = info_.layout.stride();
    std::uint32_t any = 0;
    buffers_.residuals.resize(3 * count());
    for (std::size_t i = 0; i < count(); ++i) {
      const std::byte* record = points_.attributes.data() + source(i) * stride;
      std::uint16_t rgb[3];
      std::memcpy(rgb, record + offset, sizeof rgb);
      const int shift = shiftAt < 0 ? info_.colourShift : static_cast<int>(record[shiftAt]) & 15;
      for (std::size_t c = 0; c < 3; ++c)
        any |= buffers_.residuals[3 * i + c] = residualOf(unit_, rgb[c], buffers_.colours[i] >> (8 * c) & 255u, shift);
    }
    if (any == 0) buffers_.residuals.clear();
  }

  void addResiduals() {
    const std::size_t start = buffers_.body.size();
    const auto unit = static_cast<std::uint16_t>(unit_);
    buffers_.body.resize(start + sizeof unit);
    std::memcpy(buffers_.body.data() + start, &unit, sizeof unit);
    if (buffers_.residuals.empty()) return finishPlane(kColourResidual, kConstant, start);
    const auto* const first = reinterpret_cast<const std::byte*>(buffers_.residuals.data());
    for (std::size_t c = 0; c < 3; ++c)
      appendComponent({first + 2 * c, 6, 2}, {}, count(), buffers_.spare, buffers_.body);
    finishPlane(kColourResidual, kColumns, start);
  }

  void addAttribute(int layoutIndex) {
    const Attribute& attribute = info_.layout.attributes()[static_cast<std::size_t>(layoutIndex)];
    const std::size_t offset = info_.layout.offset(static_cast<std::size_t>(layoutIndex));
    const std::size_t start = buffers_.body.size();
    const auto id = static_cast<std::uint16_t>(kFirstAttributePlane + layoutIndex);
    const std::byte* const first = points_.attributes.data() + offset;
    if (count() > 0 && isConstant(offset, attribute.bytes())) {
      buffers_.body.insert(buffers_.body.end(), first, first + attribute.bytes());
      return finishPlane(id, kConstant, start);
    }
    const std::size_t width = scalarBytes(attribute.type);
    for (std::size_t c = 0; c < attribute.components; ++c)
      appendComponent({first + c * width, info_.layout.stride(), width}, index(), count(), buffers_.spare,
                      buffers_.body);
    finishPlane(id, kColumns, start);
  }

  EncodedNode assemble(const std::size_t (&drawEnd)[3]) {
    if (buffers_.body.size() > 0xf0000000u) throw Error("points.bin", "a node takes more than 4 GB");
    head_.planeCount = static_cast<std::uint16_t>(buffers_.planes.size());
    const std::size_t levelBytes = buffers_.levelEnds.size() * sizeof(std::uint32_t);
    const std::size_t planeBytes = buffers_.planes.size() * sizeof(PayloadPlane);
    EncodedNode node;
    node.headBytes = static_cast<std::uint32_t>(sizeof head_ + levelBytes + planeBytes);
    node.payload.reserve(node.headBytes + buffers_.body.size());
    node.payload.resize(node.headBytes);
    std::byte* to = node.payload.data();
    std::memcpy(to, &head_, sizeof head_);
    if (levelBytes > 0) std::memcpy(to + sizeof head_, buffers_.levelEnds.data(), levelBytes);
    std::memcpy(to + sizeof head_ + levelBytes, buffers_.planes.data(), planeBytes);
    node.headChecksum = checksum(node.payload);
    node.payload.insert(node.payload.end(), buffers_.body.begin(), buffers_.body.end());
    for (int p = 0; p < 3; ++p) node.drawBytes[p] = static_cast<std::uint32_t>(node.headBytes + drawEnd[p]);
    return node;
  }

  const NodePoints& points_;
  const StoreInfo& info_;
  Buffers& buffers_;
  PayloadHead head_;
  ResidualUnit unit_ = ResidualUnit::shifted;
};

}  // namespace

EncodedNode encodeNode(const NodePoints& points, const StoreInfo& info, EncodeScratch& scratch) {
  if (points.count() > kMaxNodePoints)
    throw Error("points.bin", "a node has too many points, found " + std::to_string(points.count()) +
                                  " (expected at most " + std::to_string(kMaxNodePoints) + ")");
  EncodedNode node = NodeWriter(points, info, scratch.buffers()).encode();
  if (points.count() > kPointsToRemember) scratch.buffers() = {};
  return node;
}

EncodedNode encodeNode(const NodePoints& points, const StoreInfo& info) {
  EncodeScratch scratch;
  return encodeNode(points, info, scratch);
}

}  // namespace strata
