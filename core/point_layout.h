#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/scalar.h"

namespace strata {

/// A named value of every point besides its position.
struct Attribute {
  std::string name;  ///< a name from namespace attribute, or `extra:NAME` for an attribute of the source
  ScalarType type = ScalarType::u8;
  std::uint16_t components = 1;
  std::string description;  ///< as the source gives it; may be empty
  double scale = 1.0;       ///< for extra bytes: value = stored * scale + offset
  double offset = 0.0;

  std::size_t bytes() const { return scalarBytes(type) * components; }
  /// True for attributes that Strata made for drawing; they are no part of the scan.
  bool isInternal() const { return name.starts_with("strata:"); }
};

/// The names and types that every part of Strata knows. All values are kept as the source has them.
namespace attribute {
inline constexpr std::string_view kRgb = "rgb";                        // u16 x 3
inline constexpr std::string_view kNir = "nir";                        // u16
inline constexpr std::string_view kIntensity = "intensity";            // u16
inline constexpr std::string_view kClassification = "classification";  // u8
inline constexpr std::string_view kFlags = "flags";                    // u8, bits as LAS 1.4 byte 15:
// 0 synthetic, 1 key point, 2 withheld, 3 overlap, 4-5 scanner channel, 6 scan direction, 7 edge of flight line
inline constexpr std::string_view kReturnNumber = "return_number";          // u8
inline constexpr std::string_view kNumberOfReturns = "number_of_returns";   // u8
inline constexpr std::string_view kScanAngleRank = "scan_angle_rank";       // i8, degrees (LAS formats 0 to 5)
inline constexpr std::string_view kScanAngle = "scan_angle";                // i16, 0.006 degrees (formats 6 to 10)
inline constexpr std::string_view kUserData = "user_data";                  // u8
inline constexpr std::string_view kPointSourceId = "point_source_id";       // u16
inline constexpr std::string_view kGpsTime = "gps_time";                    // f64
inline constexpr std::string_view kWavePacket = "wave_packet";              // u8 x 29, the record's waveform fields
inline constexpr std::string_view kNormal = "normal";                       // f32 x 3
inline constexpr std::string_view kNormalOctahedral = "normal_octahedral";  // u8 x 2, core/octahedral.h; estimated
inline constexpr std::string_view kColourShift = "strata:colour_shift";     // u8; only in stores of sources that differ
// in it: the point's own StoreInfo::colourShift. Ours, not the sources': exports leave it out
}  // namespace attribute

/// The attributes of a cloud and the place of each in an attribute record, which has no padding and no position.
class PointLayout {
 public:
  PointLayout() = default;
  explicit PointLayout(std::vector<Attribute> attributes);

  const std::vector<Attribute>& attributes() const { return attributes_; }
  std::size_t offset(std::size_t index) const { return offsets_[index]; }
  /// Bytes of one attribute record.
  std::size_t stride() const { return stride_; }
  /// Index of the attribute with this name, or -1.
  int find(std::string_view name) const;

 private:
  std::vector<Attribute> attributes_;
  std::vector<std::size_t> offsets_;
  std::size_t stride_ = 0;
};

}  // namespace strata
