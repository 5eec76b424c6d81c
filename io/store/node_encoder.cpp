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

/// A node with more points than this gives the memory of its encoding back.
constexpr std::size_t kPointsToRemember = 1u << 18;

/// A node while it is encoded. Its planes are appended to `body`, and each is described in `planes`.
struct NodeEncoding {
  const NodePoints& points;
  const StoreInfo& info;
  PayloadHead head;
  std::vector<std::uint32_t>& levelEnds;
  PointOrder& order;
  std::vector<std::byte>& body;
  std::vector<PayloadPlane>& planes;
  Buffers& buffers;  ///< working memory of single steps

  std::size_t count() const { return points.count(); }
  /// Index of a point, given its place in stored order.
  std::size_t source(std::size_t stored) const { return order.index.empty() ? stored : order.index[stored]; }
  const std::byte* record(std::size_t point) const { return points.attributes.data() + point * info.layout.stride(); }
  std::size_t offset(int attribute) const { return info.layout.offset(static_cast<std::size_t>(attribute)); }
};

/// Bounds of the points, and the octree level from which on each axis is halved: 0 for the longest, and later for
/// shorter ones, so that cells are nearly cubes.
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

/// Levels without points are left out.
void takeLevels(const NodePoints& points, std::vector<std::uint32_t>& levelEnds) {
  levelEnds.clear();
  for (const std::uint32_t end : points.levels)
    if (end > (levelEnds.empty() ? 0 : levelEnds.back())) levelEnds.push_back(end);
  if (!levelEnds.empty() && levelEnds.back() != points.count())
    throw Error("points.bin", "levels of a node do not end at its point count");
}

NodeEncoding beginNode(const NodePoints& points, const StoreInfo& info, Buffers& buffers) {
  NodeEncoding node{points,        info,         describe(points, info), buffers.levelEnds,
                    buffers.order, buffers.body, buffers.planes,         buffers};
  node.body.clear();
  node.planes.clear();
  takeLevels(points, node.levelEnds);
  node.head.levelCount = static_cast<std::uint16_t>(node.levelEnds.size());
  node.order.index.clear();
  if (node.head.levelCount > 0) sortLevels(points, node.head, node.levelEnds, node.order);
  return node;
}

/// Describes the plane that is the body from `start` on.
void finishPlane(NodeEncoding& node, std::uint16_t id, PlaneEncoding encoding, std::size_t start) {
  PayloadPlane plane{};
  plane.id = id;
  plane.encoding = encoding;
  plane.storedBytes = static_cast<std::uint32_t>(node.body.size() - start);
  plane.checksum = checksum(std::span(node.body).subspan(start));
  node.planes.push_back(plane);
}

/// The bits of a coordinate's distance from the head's minimum that a plane takes: `width` of them, those above the
/// lowest `shift`.
struct CoordinateBits {
  int width[3], shift[3];
};

/// Appends the bit fields of the points `first` to `end` in stored order.
void appendFields(NodeEncoding& node, std::size_t first, std::size_t end, const CoordinateBits& bits) {
  const int(&width)[3] = bits.width;
  const int sum = width[0] + width[1] + width[2];
  const std::size_t bytes = packedBytes(end - first, sum);
  const std::size_t start = node.body.size();
  node.body.resize(start + bytes + kBitSlack);
  BitWriter writer(node.body.data() + start);
  std::uint64_t mask[3];
  for (int axis = 0; axis < 3; ++axis) mask[axis] = (std::uint64_t{1} << width[axis]) - 1;
  const bool narrow = sum <= 57;  // all three at once are no more than BitWriter takes
  for (std::size_t i = first; i < end && sum > 0; ++i) {
    const std::size_t from = node.source(i);
    std::uint64_t field[3];
    for (int axis = 0; axis < 3; ++axis)
      field[axis] = static_cast<std::uint64_t>(node.points.grid[axis][from] - node.head.min[axis]) >> bits.shift[axis] &
                    mask[axis];
    if (narrow) {
      writer.put(field[0] | field[1] << width[0] | field[2] << (width[0] + width[1]), sum);
    } else {
      for (int axis = 0; axis < 3; ++axis) writer.put(field[axis], width[axis]);
    }
  }
  writer.finish();
  node.body.resize(start + bytes);
}

void addPackedPositions(NodeEncoding& node, int plane) {
  const std::size_t start = node.body.size();
  const FieldWidths widths = planeWidths(node.head, plane);
  CoordinateBits bits{};
  for (int axis = 0; axis < 3; ++axis) {
    bits.width[axis] = widths.axis[axis];
    for (int below = plane + 1; below < 3; ++below) bits.shift[axis] += planeBits(node.head.bits[axis], below);
  }
  appendFields(node, 0, node.count(), bits);
  finishPlane(node, static_cast<std::uint16_t>(kPosition10 + plane), kPacked, start);
}

/// Plane 0: octrees of the levels, then for each level the bits that its octree does not tell.
void addLeadingPositions(NodeEncoding& node) {
  if (node.head.levelCount == 0) return addPackedPositions(node, 0);
  const std::size_t start = node.body.size();
  OctreeEncoder& octree = node.buffers.octree;
  std::vector<int>& depths = node.buffers.depths;
  octree.clear();
  depths.clear();
  std::size_t first = 0;
  for (const std::uint32_t end : node.levelEnds) {
    depths.push_back(octree.addLevel(node.head, std::span(node.order.keys).subspan(first, end - first)));
    first = end;
  }
  octree.append(node.body);
  first = 0;
  for (std::size_t level = 0; level < node.levelEnds.size(); ++level) {
    CoordinateBits rest{};
    for (int axis = 0; axis < 3; ++axis) {
      const int leading = planeBits(node.head.bits[axis], 0);
      rest.width[axis] = leading - octreeBits(node.head, axis, depths[level]);
      rest.shift[axis] = node.head.bits[axis] - leading;
    }
    appendFields(node, first, node.levelEnds[level], rest);
    first = node.levelEnds[level];
  }
  finishPlane(node, kPosition10, kOctree, start);
}

/// The rgb of a point, and how many of its lower bits are dropped where it is drawn.
struct PointColour {
  std::uint16_t rgb[3];
  int shift;
};

/// Reads rgb from records and, in stores whose sources differ in it, the colour shift of the point.
struct ColourReader {
  explicit ColourReader(const NodeEncoding& node)
      : colourShift(node.info.colourShift), rgbAt(node.offset(node.info.layout.find(attribute::kRgb))) {
    const int own = node.info.layout.find(attribute::kColourShift);
    hasOwnShift = own >= 0;
    if (hasOwnShift) shiftAt = node.offset(own);
  }
  PointColour read(const std::byte* record) const {
    PointColour colour;
    std::memcpy(colour.rgb, record + rgbAt, sizeof colour.rgb);
    colour.shift = hasOwnShift ? static_cast<int>(record[shiftAt]) & 15 : colourShift;
    return colour;
  }

  int colourShift;
  std::size_t rgbAt, shiftAt = 0;
  bool hasOwnShift = false;
};

/// Appends the colour plane, whose colours stay in buffers.colours. Returns the unit that the residuals count in.
ResidualUnit addColours(NodeEncoding& node) {
  const ColourReader reader(node);
  std::vector<std::uint32_t>& colours = node.buffers.colours;
  colours.resize(node.count());
  std::uint32_t unequal = 0, lower = 0;
  for (std::size_t i = 0; i < node.count(); ++i) {
    const std::size_t from = node.source(i);
    const PointColour point = reader.read(node.record(from));
    std::uint32_t colour = 0;
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t value = point.rgb[c];
      colour |= std::min(value >> point.shift, 255u) << (8 * c);
      unequal |= (value >> 8) ^ (value & 255u);
      lower |= value & 255u;
    }
    colours[i] = node.points.drawColours.empty() ? colour : node.points.drawColours[from] & 0xffffffu;
  }
  const std::size_t start = node.body.size();
  appendColours(colours, node.buffers.spare, node.body);
  finishPlane(node, kColour, kColumns, start);
  if (reader.hasOwnShift || node.info.colourShift != 8) return ResidualUnit::shifted;
  return unequal == 0 ? ResidualUnit::repeated : lower == 0 ? ResidualUnit::upper : ResidualUnit::shifted;
}

/// Fills buffers.residuals; leaves them empty when all are 0.
void gatherResiduals(NodeEncoding& node, ResidualUnit unit) {
  const ColourReader reader(node);
  std::vector<std::uint16_t>& residuals = node.buffers.residuals;
  residuals.clear();
  // The colour that an 8-bit source is drawn with holds all of its bits.
  if (unit != ResidualUnit::shifted && node.points.drawColours.empty()) return;
  std::uint32_t any = 0;
  residuals.resize(3 * node.count());
  for (std::size_t i = 0; i < node.count(); ++i) {
    const PointColour point = reader.read(node.record(node.source(i)));
    for (std::size_t c = 0; c < 3; ++c)
      any |= residuals[3 * i + c] =
          residualOf(unit, point.rgb[c], node.buffers.colours[i] >> (8 * c) & 255u, point.shift);
  }
  if (any == 0) residuals.clear();
}

/// The colours must be those that addColours() left in the buffers.
void addResiduals(NodeEncoding& node, ResidualUnit unit) {
  gatherResiduals(node, unit);
  const std::vector<std::uint16_t>& residuals = node.buffers.residuals;
  const std::size_t start = node.body.size();
  const auto unitCode = static_cast<std::uint16_t>(unit);
  node.body.resize(start + sizeof unitCode);
  std::memcpy(node.body.data() + start, &unitCode, sizeof unitCode);
  if (residuals.empty()) return finishPlane(node, kColourResidual, kConstant, start);
  const auto* const first = reinterpret_cast<const std::byte*>(residuals.data());
  for (std::size_t c = 0; c < 3; ++c)
    appendComponent({first + 2 * c, 6, 2, {}}, node.count(), node.buffers.spare, node.body);
  finishPlane(node, kColourResidual, kColumns, start);
}

/// Marks the bits of a record that differ between points, in one pass over the records by words of eight bytes.
void findDiffering(const NodeEncoding& node, std::vector<std::uint64_t>& differing) {
  const std::size_t stride = node.info.layout.stride();
  differing.assign(stride / 8 + 1, 0);
  if (node.count() == 0 || stride == 0) return;
  const std::byte* const first = node.record(0);
  const std::size_t words = stride / 8, tail = stride % 8;
  for (std::size_t i = 1; i < node.count(); ++i) {
    const std::byte* record = first + i * stride;
    for (std::size_t w = 0; w < words; ++w) {
      std::uint64_t a, b;
      std::memcpy(&a, first + 8 * w, 8);
      std::memcpy(&b, record + 8 * w, 8);
      differing[w] |= a ^ b;
    }
    for (std::size_t t = 0; t < tail; ++t)
      differing[words] |= static_cast<std::uint64_t>(first[8 * words + t] ^ record[8 * words + t]) << (8 * t);
  }
}

/// True when no point differs in these bytes of its record.
bool isConstant(const std::vector<std::uint64_t>& differing, std::size_t offset, std::size_t bytes) {
  for (std::size_t at = offset; at < offset + bytes; ++at)
    if ((differing[at / 8] >> (8 * (at % 8)) & 255u) != 0) return false;
  return true;
}

/// findDiffering() must have filled buffers.differing.
void addAttribute(NodeEncoding& node, int layoutIndex) {
  const Attribute& attribute = node.info.layout.attributes()[static_cast<std::size_t>(layoutIndex)];
  const std::size_t offset = node.offset(layoutIndex);
  const std::size_t start = node.body.size();
  const auto id = static_cast<std::uint16_t>(kFirstAttributePlane + layoutIndex);
  const std::byte* const first = node.points.attributes.data() + offset;
  if (node.count() > 0 && isConstant(node.buffers.differing, offset, attribute.bytes())) {
    node.body.insert(node.body.end(), first, first + attribute.bytes());
    return finishPlane(node, id, kConstant, start);
  }
  const std::size_t width = scalarBytes(attribute.type);
  for (std::size_t c = 0; c < attribute.components; ++c)
    appendComponent({first + c * width, node.info.layout.stride(), width, node.order.index}, node.count(),
                    node.buffers.spare, node.body);
  finishPlane(node, id, kColumns, start);
}

/// Puts the head, the ends of the levels and the directory of planes before the body. `drawEnd` are ends in the body.
EncodedNode assemble(NodeEncoding& node, const std::size_t (&drawEnd)[3]) {
  if (node.body.size() > 0xf0000000u) throw Error("points.bin", "a node takes more than 4 GB");
  PayloadHead& head = node.head;
  head.planeCount = static_cast<std::uint16_t>(node.planes.size());
  const std::size_t levelBytes = node.levelEnds.size() * sizeof(std::uint32_t);
  const std::size_t planeBytes = node.planes.size() * sizeof(PayloadPlane);
  EncodedNode encoded;
  encoded.headBytes = static_cast<std::uint32_t>(sizeof head + levelBytes + planeBytes);
  encoded.payload.reserve(encoded.headBytes + node.body.size());
  encoded.payload.resize(encoded.headBytes);
  std::byte* to = encoded.payload.data();
  std::memcpy(to, &head, sizeof head);
  if (levelBytes > 0) std::memcpy(to + sizeof head, node.levelEnds.data(), levelBytes);
  std::memcpy(to + sizeof head + levelBytes, node.planes.data(), planeBytes);
  encoded.headChecksum = checksum(encoded.payload);
  encoded.payload.insert(encoded.payload.end(), node.body.begin(), node.body.end());
  for (int p = 0; p < 3; ++p) encoded.drawBytes[p] = static_cast<std::uint32_t>(encoded.headBytes + drawEnd[p]);
  return encoded;
}

/// The planes follow each other as drawing needs them: a far node is drawn from the leading bits of its positions and
/// its colours, nearer ones need more bits, and the rest is for exports.
EncodedNode encode(const NodePoints& points, const StoreInfo& info, Buffers& buffers) {
  const PointLayout& layout = info.layout;
  const int rgb = layout.find(attribute::kRgb);
  const int intensity = layout.find(attribute::kIntensity);
  const int classification = layout.find(attribute::kClassification);
  std::size_t drawEnd[3];
  ResidualUnit unit = ResidualUnit::shifted;

  NodeEncoding node = beginNode(points, info, buffers);
  findDiffering(node, buffers.differing);
  addLeadingPositions(node);
  if (rgb >= 0) unit = addColours(node);
  if (intensity >= 0) addAttribute(node, intensity);
  if (classification >= 0) addAttribute(node, classification);
  drawEnd[0] = node.body.size();
  addPackedPositions(node, 1);
  drawEnd[1] = node.body.size();
  addPackedPositions(node, 2);
  drawEnd[2] = node.body.size();
  if (rgb >= 0) addResiduals(node, unit);
  for (int i = 0; i < static_cast<int>(layout.attributes().size()); ++i)
    if (i != rgb && i != intensity && i != classification) addAttribute(node, i);
  return assemble(node, drawEnd);
}

}  // namespace

EncodedNode encodeNode(const NodePoints& points, const StoreInfo& info, EncodeScratch& scratch) {
  if (points.count() > kMaxNodePoints)
    throw Error("points.bin", "a node has too many points, found " + std::to_string(points.count()) +
                                  " (expected at most " + std::to_string(kMaxNodePoints) + ")");
  EncodedNode node = encode(points, info, scratch.buffers());
  if (points.count() > kPointsToRemember) scratch.buffers() = {};
  return node;
}

EncodedNode encodeNode(const NodePoints& points, const StoreInfo& info) {
  EncodeScratch scratch;
  return encodeNode(points, info, scratch);
}

}  // namespace strata
