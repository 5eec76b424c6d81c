#include "core/point_layout.h"

#include <array>
#include <utility>

#include "core/error.h"

namespace strata {
namespace {
struct ScalarInfo {
  std::string_view name;
  std::size_t bytes;
};
constexpr std::array<ScalarInfo, 10> kScalars{{{"u8", 1},
                                               {"i8", 1},
                                               {"u16", 2},
                                               {"i16", 2},
                                               {"u32", 4},
                                               {"i32", 4},
                                               {"u64", 8},
                                               {"i64", 8},
                                               {"f32", 4},
                                               {"f64", 8}}};
}  // namespace

std::size_t scalarBytes(ScalarType type) { return kScalars.at(static_cast<std::size_t>(type)).bytes; }
std::string_view scalarName(ScalarType type) { return kScalars.at(static_cast<std::size_t>(type)).name; }

ScalarType parseScalarType(std::string_view name) {
  for (std::size_t i = 0; i < kScalars.size(); ++i)
    if (kScalars[i].name == name) return static_cast<ScalarType>(i);
  throw Error("unknown attribute type '" + std::string(name) + "'");
}

PointLayout::PointLayout(std::vector<Attribute> attributes) : attributes_(std::move(attributes)) {
  for (const Attribute& a : attributes_) {
    offsets_.push_back(stride_);
    stride_ += a.bytes();
  }
}

int PointLayout::find(std::string_view name) const {
  for (std::size_t i = 0; i < attributes_.size(); ++i)
    if (attributes_[i].name == name) return static_cast<int>(i);
  return -1;
}

}  // namespace strata
