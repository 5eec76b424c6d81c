#include "tests/support/pcl_oracle.h"

#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>

#include <cstring>
#include <exception>

namespace strata::test {
namespace {

template <typename T>
double load(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

double loadField(const std::uint8_t* bytes, std::uint8_t type) {
  switch (type) {
    case pcl::PCLPointField::INT8:
      return load<std::int8_t>(bytes);
    case pcl::PCLPointField::UINT8:
      return load<std::uint8_t>(bytes);
    case pcl::PCLPointField::INT16:
      return load<std::int16_t>(bytes);
    case pcl::PCLPointField::UINT16:
      return load<std::uint16_t>(bytes);
    case pcl::PCLPointField::INT32:
      return load<std::int32_t>(bytes);
    case pcl::PCLPointField::UINT32:
      return load<std::uint32_t>(bytes);
    case pcl::PCLPointField::FLOAT64:
      return load<double>(bytes);
    default:
      return load<float>(bytes);
  }
}

}  // namespace

std::optional<PclCloud> readWithPcl(const std::string& path) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  pcl::PCLPointCloud2 cloud;
  try {
    const int result = path.ends_with(".ply") ? pcl::PLYReader().read(path, cloud) : pcl::PCDReader().read(path, cloud);
    if (result != 0) return std::nullopt;
  } catch (const std::exception&) {
    return std::nullopt;
  }
  PclCloud out;
  out.points = std::uint64_t{cloud.width} * cloud.height;
  if (cloud.data.size() < out.points * cloud.point_step) return std::nullopt;  // a PLY camera makes it claim more
  for (const pcl::PCLPointField& field : cloud.fields) {
    out.fields.push_back(field.name);
    std::vector<double>& values = out.values.emplace_back();
    for (std::uint64_t i = 0; i < out.points; ++i)
      values.push_back(loadField(cloud.data.data() + i * cloud.point_step + field.offset, field.datatype));
  }
  return out;
}

}  // namespace strata::test
