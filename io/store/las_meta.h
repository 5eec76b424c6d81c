#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace strata {

/// The contents of a LAS or LAZ file beyond its points. A store keeps them so that an export gives them back.
struct LasMeta {
  struct Vlr {
    std::string userId;
    std::uint16_t recordId = 0;
    std::string description;
    std::vector<std::uint8_t> data;
  };
  std::uint8_t versionMinor = 2;
  std::uint8_t pointFormat = 0;
  std::uint16_t recordBytes = 20;  ///< of the uncompressed record, extra bytes included
  glm::dvec3 scale{0.001};         ///< of the header; an export uses them again where the points fit
  glm::dvec3 offset{0.0};
  std::uint16_t globalEncoding = 0;
  std::uint16_t fileSourceId = 0;
  std::uint16_t creationDay = 0;
  std::uint16_t creationYear = 0;
  std::string systemIdentifier;
  std::string generatingSoftware;
  std::vector<Vlr> vlrs;  ///< without LASzip's own and COPC's
};

}  // namespace strata
