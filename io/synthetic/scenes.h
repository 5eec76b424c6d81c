#pragma once
#include <cstdint>
#include <memory>

namespace strata::synthetic {

class ScannerScan;

/// A city around a square with a church, scanned from its crossings and from the air. It grows with the points: 3 x 3
/// blocks for a million, 6 x 6 for a billion.
std::unique_ptr<ScannerScan> makeCity(std::uint64_t points, std::uint64_t seed);
/// An office floor: rooms on both sides of a corridor, each with two stations. It grows with the points, from 4 rooms
/// to 20.
std::unique_ptr<ScannerScan> makeRoom(std::uint64_t points, std::uint64_t seed);

}  // namespace strata::synthetic
