#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "io/scan/point_source.h"

namespace strata {

/// Columns of the `extraBytes` bytes that follow a format's own fields, in their order, covering all of them: those
/// that Extra Bytes records (LASF_Spec 4; LAS 1.4 R15, tables 24 and 25) describe as `extra:NAME`, the rest as
/// `extra:bytes`. The deprecated types for pairs and triples become components. Names are unique.
std::vector<Attribute> extraAttributes(const std::vector<LasMeta::Vlr>& vlrs, std::size_t extraBytes);

/// The Extra Bytes record that describes `attributes`: one entry a component, but one untyped entry for bytes in a
/// row. Names lose their `extra:`.
LasMeta::Vlr encodeExtraBytes(const std::vector<Attribute>& attributes);
bool isExtraBytes(const LasMeta::Vlr& vlr);

/// The WKT of the file, or "EPSG:n" from its GeoTIFF keys (projected before geographic), or empty.
std::string lasCrs(const std::vector<LasMeta::Vlr>& vlrs);

/// The record that states `crs` (WKT or "EPSG:n"). WKT wants kWktBit in the header's global encoding.
LasMeta::Vlr encodeCrs(const std::string& crs);
bool isCrs(const LasMeta::Vlr& vlr);
inline constexpr std::uint16_t kWktBit = 1 << 4;

/// LASzip's record: how the points of a LAZ file are compressed.
bool isLaszip(const LasMeta::Vlr& vlr);
/// Records that describe where points stand in a COPC file, true of no other file.
bool isCopc(const LasMeta::Vlr& vlr);

}  // namespace strata
