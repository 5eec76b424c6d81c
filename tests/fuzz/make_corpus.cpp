// Writes the first inputs of every fuzz target: make_corpus FOLDER. The same program always writes the same bytes.
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "io/store/node_codec.h"
#include "io/store/store_info.h"
#include "tests/support/las_maker.h"

namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& bytes) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
}

/// The store that node_payload_fuzz.cpp decodes nodes of.
strata::StoreInfo storeInfo() {
  strata::StoreInfo info;
  info.layout = strata::PointLayout({{"rgb", strata::ScalarType::u16, 3, "", 1.0, 0.0},
                                     {"intensity", strata::ScalarType::u16, 1, "", 1.0, 0.0},
                                     {"classification", strata::ScalarType::u8, 1, "", 1.0, 0.0},
                                     {"gps_time", strata::ScalarType::f64, 1, "", 1.0, 0.0}});
  info.cubeBits = 30;
  return info;
}

/// The target's input: the number of points, the bytes of the head, and the payload.
std::string nodePayload(std::size_t count, std::uint32_t extent, unsigned attributeMask) {
  const strata::StoreInfo info = storeInfo();
  std::mt19937 random(static_cast<std::uint32_t>(count));
  strata::NodePoints points;
  for (auto& axis : points.grid)
    for (std::size_t i = 0; i < count; ++i) axis.push_back(random() % extent);
  points.attributes.resize(count * info.layout.stride());
  for (std::byte& value : points.attributes) value = static_cast<std::byte>(random() & attributeMask);
  const strata::EncodedNode node = strata::encodeNode(points, info);
  const auto head = static_cast<std::uint16_t>(node.headBytes), points16 = static_cast<std::uint16_t>(count);
  std::string bytes(4, '\0');
  std::memcpy(bytes.data(), &points16, 2);
  std::memcpy(bytes.data() + 2, &head, 2);
  return bytes.append(reinterpret_cast<const char*>(node.payload.data()), node.payload.size());
}

void writeLas(const fs::path& folder) {
  for (const int format : {0, 1, 3, 6, 7}) {
    strata::test::LasSpec spec;
    spec.format = format;
    spec.versionMinor = format >= 6 ? 4 : 2;
    spec.points = {{0, 0, 0}, {100, -200, 300}, {2000000000, 5, -7}};
    const std::string name = "format" + std::to_string(format);
    write(folder / (name + ".las"), strata::test::lasBytes(spec));
    spec.claimedPoints = std::uint64_t{1} << 31;
    write(folder / (name + "_claims_more.las"), strata::test::lasBytes(spec));
    spec.claimedPoints.reset();
    spec.claimedRecordBytes = std::uint16_t{9};
    write(folder / (name + "_short_records.las"), strata::test::lasBytes(spec));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const fs::path folder = argv[1];
  writeLas(folder / "las_header");
  write(folder / "node_payload/one_point", nodePayload(1, 1u << 30, 255));
  write(folder / "node_payload/constant", nodePayload(40, 64, 0));
  write(folder / "node_payload/few_values", nodePayload(300, 1u << 12, 3));
  write(folder / "node_payload/noise", nodePayload(200, 1u << 30, 255));
  write(folder / "store_json/four_attributes.json", strata::storeInfoJson(storeInfo()));
  write(folder / "store_json/no_object.json", "[1, 2, {\"format\": null}]");
  write(folder / "pcd_header/binary.pcd",
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
        "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA binary\n");
  write(
      folder / "pcd_header/more_points_than_cells.pcd",
      "VERSION .7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH 4294967295\nHEIGHT 4294967295\nPOINTS 1\nDATA ascii\n");
  write(folder / "ply_header/little_endian.ply",
        "ply\nformat binary_little_endian 1.0\ncomment made\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n");
  write(folder / "ply_header/too_many.ply",
        "ply\nformat ascii 1.0\nelement vertex 18446744073709551615\nproperty double x\nproperty double y\n"
        "property double z\nend_header\n");
  write(folder / "text/named_columns.csv", "x,y,z,intensity\n1,2,3,10\n-4.5,1e3,0.25,65535\n");
  write(folder / "text/pts.pts", "2\n0.1 0.2 0.3 -2047 255 0 128\n1 2 3 2048 1 2 3\n");
  write(folder / "text/damaged.xyz", "# comment\n1 2 3\n4 five 6\n\n7;8;9\n nan inf 1e999\n");
}
