#include "io/store/plane_sizes.h"

#include <algorithm>
#include <cstdio>

#include "io/store/payload_head.h"

namespace strata {
namespace {

std::string planeName(std::uint16_t id, const StoreInfo& info) {
  switch (id) {
    case kPosition10:
      return "position 10";
    case kPosition20:
      return "position 20";
    case kPosition30:
      return "position 30+";
    case kColour:
      return "colour";
    case kColourResidual:
      return "colour residual";
    default:
      break;
  }
  const std::size_t index = static_cast<std::size_t>(id) - kFirstAttributePlane;
  return id >= kFirstAttributePlane && index < info.layout.attributes().size() ? info.layout.attributes()[index].name
                                                                               : "plane " + std::to_string(id);
}

std::uint64_t rawBytes(const PayloadHead& head, std::uint16_t id, const StoreInfo& info) {
  if (id <= kPosition30) return packedBytes(head.pointCount, planeWidths(head, id).sum());
  if (id == kColour) return std::uint64_t{3} * head.pointCount;
  if (id == kColourResidual) return std::uint64_t{3} * head.pointCount;  // with the colour, the 6 bytes of rgb
  const std::size_t index = static_cast<std::size_t>(id) - kFirstAttributePlane;
  return id >= kFirstAttributePlane && index < info.layout.attributes().size()
             ? info.layout.attributes()[index].bytes() * std::uint64_t{head.pointCount}
             : 0;
}

}  // namespace

std::vector<PlaneSize> planeSizes(const Store& store) {
  std::vector<PlaneSize> sizes{{"heads", 0, 0}};
  std::vector<std::uint16_t> ids{0xffff};
  std::vector<std::byte> bytes;
  for (const NodeRecord& record : store.hierarchy().nodes) {
    bytes.resize(record.headBytes);
    store.points().read(record.offset, bytes);
    const ParsedHead parsed = parseHead(record, bytes);
    sizes[0].bytes += record.headBytes;
    for (const PayloadPlane& plane : parsed.planes) {
      auto at = static_cast<std::size_t>(std::find(ids.begin(), ids.end(), plane.id) - ids.begin());
      if (at == ids.size()) {
        ids.push_back(plane.id);
        sizes.push_back({planeName(plane.id, store.info()), 0, 0});
      }
      sizes[at].bytes += plane.storedBytes;
      sizes[at].rawBytes += rawBytes(parsed.head, plane.id, store.info());
    }
  }
  return sizes;
}

std::string planeSizesText(const std::vector<PlaneSize>& planes, std::uint64_t points) {
  std::string text;
  const double perPoint = points > 0 ? 1.0 / static_cast<double>(points) : 0.0;
  for (const PlaneSize& plane : planes) {
    char line[160];
    std::snprintf(line, sizeof line, "  %-18s %7.3f of %6.3f bytes a point\n", plane.name.c_str(),
                  static_cast<double>(plane.bytes) * perPoint, static_cast<double>(plane.rawBytes) * perPoint);
    text += line;
  }
  return text;
}

}  // namespace strata
