#include "io/las/las_vlr.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <set>

#include "io/las/las_header.h"

namespace strata {
namespace {

constexpr std::size_t kEntryBytes = 192;  // of the descriptor of one field
constexpr std::uint8_t kScaleOption = 1 << 3;
constexpr std::uint8_t kOffsetOption = 1 << 4;
constexpr ScalarType kTypes[10] = {ScalarType::u8,  ScalarType::i8,  ScalarType::u16, ScalarType::i16, ScalarType::u32,
                                   ScalarType::i32, ScalarType::u64, ScalarType::i64, ScalarType::f32, ScalarType::f64};
constexpr std::string_view kPrefix = "extra:";

constexpr std::uint16_t kWktRecord = 2112;
constexpr std::uint16_t kGeoKeysRecord = 34735;
constexpr std::uint16_t kGeoDoublesRecord = 34736;
constexpr std::uint16_t kGeoTextRecord = 34737;
constexpr std::uint16_t kProjectedKey = 3072, kGeographicKey = 2048, kModelTypeKey = 1024;
constexpr std::uint16_t kUserDefined = 32767;

template <typename T>
T load(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

template <typename T>
void append(std::vector<std::uint8_t>& bytes, T value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof(T));
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

std::string field(const std::uint8_t* bytes, std::size_t size) {
  return lasText({reinterpret_cast<const char*>(bytes), size});
}

/// Decodes a descriptor; `components` is 0 for an unknown type.
Attribute decodeEntry(const std::uint8_t* entry) {
  Attribute attribute;
  const std::uint8_t type = entry[2], options = entry[3];
  attribute.name = std::string(kPrefix) + field(entry + 4, 32);
  attribute.description = field(entry + 160, 32);
  if (type == 0) {
    attribute.components = options;  // untyped bytes: the options field is their number
  } else if (type <= 30) {
    attribute.type = kTypes[(type - 1) % 10];
    attribute.components = static_cast<std::uint16_t>(1 + (type - 1) / 10);
    if ((options & kScaleOption) != 0) attribute.scale = load<double>(entry + 112);
    if ((options & kOffsetOption) != 0) attribute.offset = load<double>(entry + 136);
  } else {
    attribute.components = 0;
  }
  return attribute;
}

void makeUnique(std::vector<Attribute>& attributes) {
  std::set<std::string> taken;
  for (Attribute& attribute : attributes) {
    const std::string wanted = attribute.name;
    for (int n = 2; !taken.insert(attribute.name).second; ++n) attribute.name = wanted + "_" + std::to_string(n);
  }
}

void encodeEntry(std::vector<std::uint8_t>& bytes, const Attribute& attribute, const std::string& name, bool untyped) {
  const std::size_t at = bytes.size();
  bytes.resize(at + kEntryBytes);
  std::uint8_t* entry = bytes.data() + at;
  const auto type = std::find(std::begin(kTypes), std::end(kTypes), attribute.type) - std::begin(kTypes) + 1;
  const bool scaled = attribute.scale != 1.0 || attribute.offset != 0.0;
  entry[2] = untyped ? std::uint8_t{0} : static_cast<std::uint8_t>(type);
  entry[3] = untyped ? static_cast<std::uint8_t>(attribute.components)
                     : static_cast<std::uint8_t>(scaled ? kScaleOption | kOffsetOption : 0);
  std::memcpy(entry + 4, name.data(), std::min<std::size_t>(name.size(), 32));
  if (scaled && !untyped) {
    std::memcpy(entry + 112, &attribute.scale, sizeof(double));
    std::memcpy(entry + 136, &attribute.offset, sizeof(double));
  }
  std::memcpy(entry + 160, attribute.description.data(), std::min<std::size_t>(attribute.description.size(), 32));
}

/// The value of a key in a GeoTIFF key directory; 0 when it is absent or stored outside of the directory.
std::uint16_t geoKey(const std::vector<std::uint8_t>& directory, std::uint16_t wanted) {
  for (std::size_t at = 8; at + 8 <= directory.size(); at += 8) {
    const auto key = load<std::uint16_t>(directory.data() + at);
    const auto location = load<std::uint16_t>(directory.data() + at + 2);
    const auto value = load<std::uint16_t>(directory.data() + at + 6);
    if (key == wanted && location == 0) return value;
  }
  return 0;
}

}  // namespace

std::vector<Attribute> extraAttributes(const std::vector<LasMeta::Vlr>& vlrs, std::size_t extraBytes) {
  std::vector<Attribute> attributes;
  std::size_t left = extraBytes;
  bool known = true;
  for (const LasMeta::Vlr& vlr : vlrs) {
    if (!isExtraBytes(vlr)) continue;
    for (std::size_t at = 0; known && at + kEntryBytes <= vlr.data.size(); at += kEntryBytes) {
      Attribute attribute = decodeEntry(vlr.data.data() + at);
      known = attribute.components != 0 && attribute.bytes() <= left;
      if (!known) break;
      left -= attribute.bytes();
      attributes.push_back(std::move(attribute));
    }
  }
  if (left != 0) {
    Attribute rest;
    rest.name = std::string(kPrefix) + "bytes";
    rest.components = static_cast<std::uint16_t>(left);
    attributes.push_back(std::move(rest));
  }
  makeUnique(attributes);
  return attributes;
}

LasMeta::Vlr encodeExtraBytes(const std::vector<Attribute>& attributes) {
  LasMeta::Vlr vlr{"LASF_Spec", 4, "Extra Bytes", {}};
  for (const Attribute& attribute : attributes) {
    const std::string name =
        attribute.name.starts_with(kPrefix) ? attribute.name.substr(kPrefix.size()) : attribute.name;
    if (attribute.components == 1) {
      encodeEntry(vlr.data, attribute, name, false);
    } else if (attribute.type == ScalarType::u8 && attribute.components <= 255) {
      encodeEntry(vlr.data, attribute, name, true);
    } else {
      for (int i = 0; i < attribute.components; ++i)
        encodeEntry(vlr.data, attribute, name + "[" + std::to_string(i) + "]", false);
    }
  }
  return vlr;
}

std::string lasCrs(const std::vector<LasMeta::Vlr>& vlrs) {
  for (const LasMeta::Vlr& vlr : vlrs) {
    if (vlr.userId != "LASF_Projection" || vlr.recordId != kWktRecord) continue;
    std::string wkt = field(vlr.data.data(), vlr.data.size());
    if (!wkt.empty()) return wkt;
  }
  for (const LasMeta::Vlr& vlr : vlrs) {
    if (vlr.userId != "LASF_Projection" || vlr.recordId != kGeoKeysRecord) continue;
    for (const std::uint16_t key : {kProjectedKey, kGeographicKey}) {
      const std::uint16_t code = geoKey(vlr.data, key);
      if (code != 0 && code != kUserDefined) return "EPSG:" + std::to_string(code);
    }
  }
  return {};
}

LasMeta::Vlr encodeCrs(const std::string& crs) {
  std::uint16_t code = 0;
  if (crs.starts_with("EPSG:") &&
      std::from_chars(crs.data() + 5, crs.data() + crs.size(), code).ptr == crs.data() + crs.size()) {
    // Codes of geographic systems in the EPSG registry are 4001 to 4999.
    const bool geographic = code >= 4001 && code <= 4999;
    LasMeta::Vlr vlr{"LASF_Projection", kGeoKeysRecord, "GeoTIFF keys", {}};
    const std::uint16_t model = geographic ? 2 : 1, key = geographic ? kGeographicKey : kProjectedKey;
    for (const std::uint16_t value :
         {std::uint16_t{1}, std::uint16_t{1}, std::uint16_t{0}, std::uint16_t{2}, kModelTypeKey, std::uint16_t{0},
          std::uint16_t{1}, model, key, std::uint16_t{0}, std::uint16_t{1}, code})
      append(vlr.data, value);
    return vlr;
  }
  LasMeta::Vlr vlr{"LASF_Projection", kWktRecord, "OGC WKT", {crs.begin(), crs.end()}};
  vlr.data.push_back(0);
  return vlr;
}

bool isExtraBytes(const LasMeta::Vlr& vlr) { return vlr.userId == "LASF_Spec" && vlr.recordId == 4; }

bool isCrs(const LasMeta::Vlr& vlr) {
  return vlr.userId == "LASF_Projection" && (vlr.recordId == kWktRecord || vlr.recordId == kGeoKeysRecord ||
                                             vlr.recordId == kGeoDoublesRecord || vlr.recordId == kGeoTextRecord);
}

bool isLaszip(const LasMeta::Vlr& vlr) { return vlr.userId == "laszip encoded" && vlr.recordId == 22204; }

bool isCopc(const LasMeta::Vlr& vlr) { return vlr.userId == "copc" && (vlr.recordId == 1 || vlr.recordId == 1000); }

}  // namespace strata
