#include "io/scan/point_source.h"

namespace strata {

bool PointReader::readIntegers(PointBlock&, std::size_t) {
  throw Error("this scan has no integer coordinates");  // a caller that did not look at SourceInfo::las
}

}  // namespace strata
