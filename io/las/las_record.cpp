#include "io/las/las_record.h"

#include <cstring>

#include "io/las/las_header.h"
#include "io/las/las_vlr.h"

namespace strata {
namespace {

// Both kinds of record start with x, y, z (i32), intensity (u16) and two or three bytes of bit fields.
constexpr std::size_t kIntensityAt = 12;
constexpr std::size_t kReturnsAt = 14;
constexpr std::size_t kHead = 6;              // packed: intensity, returns, classification, flags
constexpr std::size_t kTailAt[2] = {16, 17};  // first byte that is copied unchanged; [1] for formats 6 to 10

/// kTail is the number of bytes that are copied unchanged, or 0 when `tail` gives it at run time. A constant lets the
/// compiler turn the copy into a few moves.
template <bool kExtended, std::size_t kTail, typename Put, typename Position>
void unpack(const std::byte* record, std::size_t tail, Put put, std::span<Position> positions, std::byte* out) {
  const std::size_t copied = kTail != 0 ? kTail : tail;
  for (Position& position : positions) {
    std::int32_t xyz[3];
    std::memcpy(xyz, record, sizeof xyz);
    position = put(xyz);

    const auto byte = [&](std::size_t at) { return static_cast<unsigned>(record[at]); };
    const unsigned returns = byte(kReturnsAt), next = byte(kReturnsAt + 1);
    unsigned returnNumber, numberOfReturns, classification, flags;
    if constexpr (kExtended) {
      returnNumber = returns & 15;
      numberOfReturns = returns >> 4;
      classification = byte(kReturnsAt + 2);
      flags = next;
    } else {
      returnNumber = returns & 7;
      numberOfReturns = returns >> 3 & 7;
      classification = next & 31;
      flags = next >> 5 | (returns & 0xc0);
    }
    const unsigned middle = returnNumber | numberOfReturns << 8 | classification << 16 | flags << 24;
    std::memcpy(out, record + kIntensityAt, 2);
    std::memcpy(out + 2, &middle, 4);
    std::memcpy(out + kHead, record + kTailAt[kExtended], copied);
    record += kTailAt[kExtended] + copied;
    out += kHead + copied;
  }
}

template <bool kExtended>
void pack(std::span<const glm::ivec3> integers, const std::byte* in, std::size_t tail, std::byte* record) {
  for (const glm::ivec3& xyz : integers) {
    std::memcpy(record, &xyz.x, 4);
    std::memcpy(record + 4, &xyz.y, 4);
    std::memcpy(record + 8, &xyz.z, 4);
    std::memcpy(record + kIntensityAt, in, 2);
    const auto byte = [&](std::size_t at) { return static_cast<unsigned>(in[at]); };
    const unsigned returnNumber = byte(2), numberOfReturns = byte(3), classification = byte(4), flags = byte(5);
    if constexpr (kExtended) {
      record[kReturnsAt] = static_cast<std::byte>((returnNumber & 15) | numberOfReturns << 4);
      record[kReturnsAt + 1] = static_cast<std::byte>(flags);
      record[kReturnsAt + 2] = static_cast<std::byte>(classification);
    } else {
      record[kReturnsAt] = static_cast<std::byte>((returnNumber & 7) | (numberOfReturns & 7) << 3 | (flags & 0xc0));
      record[kReturnsAt + 1] = static_cast<std::byte>((classification & 31) | flags << 5);
    }
    std::memcpy(record + kTailAt[kExtended], in + kHead, tail);
    in += kHead + tail;
    record += kTailAt[kExtended] + tail;
  }
}

std::size_t tailBytes(const LasRecordFormat& format) { return format.recordBytes - kTailAt[format.extended()]; }

Attribute column(std::string_view name, ScalarType type, std::uint16_t components = 1) {
  Attribute attribute;
  attribute.name = name;
  attribute.type = type;
  attribute.components = components;
  return attribute;
}

bool among(int value, std::initializer_list<int> values) {
  for (const int each : values)
    if (each == value) return true;
  return false;
}

}  // namespace

PointLayout lasLayout(const LasRecordFormat& format, const std::vector<LasMeta::Vlr>& vlrs) {
  using enum ScalarType;
  std::vector<Attribute> columns{column(attribute::kIntensity, u16), column(attribute::kReturnNumber, u8),
                                 column(attribute::kNumberOfReturns, u8), column(attribute::kClassification, u8),
                                 column(attribute::kFlags, u8)};
  if (format.extended()) {
    columns.push_back(column(attribute::kUserData, u8));
    columns.push_back(column(attribute::kScanAngle, i16));
  } else {
    columns.push_back(column(attribute::kScanAngleRank, i8));
    columns.push_back(column(attribute::kUserData, u8));
  }
  columns.push_back(column(attribute::kPointSourceId, u16));
  const int id = format.pointFormat;
  if (!among(id, {0, 2})) columns.push_back(column(attribute::kGpsTime, f64));
  if (among(id, {2, 3, 5, 7, 8, 10})) columns.push_back(column(attribute::kRgb, u16, 3));
  if (among(id, {8, 10})) columns.push_back(column(attribute::kNir, u16));
  if (among(id, {4, 5, 9, 10})) columns.push_back(column(attribute::kWavePacket, u8, 29));
  for (Attribute& extra : extraAttributes(vlrs, format.recordBytes - std::size_t{lasFormatBytes(id)}))
    columns.push_back(std::move(extra));
  return PointLayout(std::move(columns));
}

std::size_t lasStride(const LasRecordFormat& format) { return kHead + tailBytes(format); }

namespace {

template <typename Put, typename Position>
void unpackAll(const LasRecordFormat& format, const std::byte* records, Put put, std::span<Position> positions,
               std::byte* attributes) {
  const std::size_t tail = tailBytes(format);
  const auto run = [&]<bool kExtended, std::size_t kTail>() {
    unpack<kExtended, kTail>(records, tail, put, positions, attributes);
  };
  if (format.extended()) {
    switch (format.recordBytes) {
      case 30:
        return run.template operator()<true, 13>();
      case 36:
        return run.template operator()<true, 19>();
      case 38:
        return run.template operator()<true, 21>();
      default:
        return run.template operator()<true, 0>();
    }
  }
  switch (format.recordBytes) {
    case 20:
      return run.template operator()<false, 4>();
    case 26:
      return run.template operator()<false, 10>();
    case 28:
      return run.template operator()<false, 12>();
    case 34:
      return run.template operator()<false, 18>();
    default:
      return run.template operator()<false, 0>();
  }
}

}  // namespace

void unpackLasRecords(const LasRecordFormat& format, const glm::dvec3& scale, const std::byte* records,
                      std::span<glm::dvec3> positions, std::byte* attributes) {
  unpackAll(
      format, records, [&scale](const std::int32_t(&xyz)[3]) { return glm::dvec3(xyz[0], xyz[1], xyz[2]) * scale; },
      positions, attributes);
}

void unpackLasRecords(const LasRecordFormat& format, const std::byte* records, std::span<glm::ivec3> integers,
                      std::byte* attributes) {
  unpackAll(
      format, records, [](const std::int32_t(&xyz)[3]) { return glm::ivec3(xyz[0], xyz[1], xyz[2]); }, integers,
      attributes);
}

void packLasRecords(const LasRecordFormat& format, std::span<const glm::ivec3> integers, const std::byte* attributes,
                    std::byte* records) {
  if (format.extended())
    pack<true>(integers, attributes, tailBytes(format), records);
  else
    pack<false>(integers, attributes, tailBytes(format), records);
}

}  // namespace strata
