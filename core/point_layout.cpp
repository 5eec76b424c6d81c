#include "core/point_layout.h"

#include <utility>

namespace strata {

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
