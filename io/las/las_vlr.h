#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "io/scan/point_source.h"

namespace strata {

/// The attributes of the `extraBytes` bytes behind a format's own fields, in their order. Bytes that Extra Bytes VLRs
/// (LASF_Spec 4; LAS 1.4 R15, tables 24 and 25) describe become `extra:NAME`, and the rest becomes `extra:bytes`. The
/// deprecated types for pairs and triples become components. All names differ.
std::vector<Attribute> extraAttributes(const std::vector<LasMeta::Vlr>& vlrs, std::size_t extraBytes);

/// The Extra Bytes VLR that describes `attributes`: one descriptor for each component, but a single untyped one for
/// several bytes. Names lose their `extra:`.
LasMeta::Vlr encodeExtraBytes(const std::vector<Attribute>& attributes);
bool isExtraBytes(const LasMeta::Vlr& vlr);

/// The coordinate system of a file: its WKT, or "EPSG:n" from its GeoTIFF keys (projected before geographic), or empty.
std::string lasCrs(const std::vector<LasMeta::Vlr>& vlrs);

/// The VLR that states `crs`, which is WKT or "EPSG:n". WKT needs kWktBit in the header's global encoding.
LasMeta::Vlr encodeCrs(const std::string& crs);
bool isCrs(const LasMeta::Vlr& vlr);
inline constexpr std::uint16_t kWktBit = 1 << 4;

/// True for LASzip's VLR, which says how the points of a LAZ file are compressed.
bool isLaszip(const LasMeta::Vlr& vlr);
/// True for the VLRs that say where a COPC file has its points. They hold for no other file.
bool isCopc(const LasMeta::Vlr& vlr);

}  // namespace strata
