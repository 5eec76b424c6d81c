#include "viewer/session/class_census.h"

#include <array>

namespace strata {
namespace {

constexpr std::array kNames{"never classified",
                            "unclassified",
                            "ground",
                            "low vegetation",
                            "medium vegetation",
                            "high vegetation",
                            "building",
                            "low noise",
                            "reserved 8",
                            "water",
                            "rail",
                            "road surface",
                            "reserved 12",
                            "wire, guard",
                            "wire, conductor",
                            "transmission tower",
                            "wire connector",
                            "bridge deck",
                            "high noise",
                            "overhead structure",
                            "ignored ground",
                            "snow",
                            "temporal exclusion"};
constexpr std::uint8_t kFirstOwn = 64;

}  // namespace

std::string className(std::uint8_t classification) {
  if (classification < kNames.size()) return kNames[classification];
  return (classification < kFirstOwn ? "reserved " : "own ") + std::to_string(classification);
}

bool ClassCensus::add(std::size_t store, const NodeData& node) {
  if (node.classification.empty() || !met_.insert({store, {node.key.code, node.pointCount()}}).second) return false;
  const std::size_t before = present_.count();
  for (const std::uint8_t c : node.classification) present_.set(c);
  return present_.count() != before;
}

}  // namespace strata
