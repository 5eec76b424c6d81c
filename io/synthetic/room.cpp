#include <algorithm>
#include <cmath>

#include "io/synthetic/scanner.h"
#include "io/synthetic/scene_builder.h"
#include "io/synthetic/scenes.h"

namespace strata::synthetic {
namespace {

// The floor's plan: rooms in two rows, a corridor between them along x.
constexpr float kRoomWidth = 4.8f, kRoomDepth = 6.0f;
constexpr float kCorridor = 2.4f, kWall = 0.15f, kOuterWall = 0.3f;
constexpr float kHeight = 2.8f;
constexpr float kDoorFrom = 0.5f, kDoorTo = 1.5f, kDoorHeight = 2.1f;  // from the room's western wall
constexpr float kCorridorLow = kRoomDepth + kWall, kCorridorHigh = kCorridorLow + kCorridor;
constexpr float kNorthLow = kCorridorHigh + kWall, kNorthHigh = kNorthLow + kRoomDepth;
constexpr float kCellM = 0.8f;
constexpr float kTripodM = 1.6f;

/// A room in coordinates of its own: its window is at y = 0 and its door at y = kRoomDepth. North rooms are mirrored.
struct RoomPlan {
  float west;
  bool north;

  float y(float local) const { return north ? kNorthHigh - local : local; }
  glm::vec3 at(float x, float localY, float z) const { return {west + x, y(localY), z}; }
};

void addDesk(SceneBuilder& b, const RoomPlan& room, float x, float y) {
  b.block(room.at(x, y, 0.72f), {1.6f, 0.8f, 0.03f}, Material::wood, 11);
  for (const float end : {-0.75f, 0.75f}) b.block(room.at(x + end, y, 0.0f), {0.04f, 0.7f, 0.72f}, Material::metal);
  b.block(room.at(x + 0.5f, y, 0.1f), {0.42f, 0.6f, 0.55f}, Material::metal, 3);
  b.block(room.at(x, y - 0.2f, 0.75f), {0.25f, 0.18f, 0.02f}, Material::metal);
  b.block(room.at(x, y - 0.22f, 0.77f), {0.04f, 0.04f, 0.15f}, Material::metal);
  b.block(room.at(x, y - 0.2f, 0.88f), {0.60f, 0.04f, 0.36f}, Material::screen, b.newSeed());
  b.block(room.at(x, y + 0.16f, 0.75f), {0.44f, 0.15f, 0.02f}, Material::rubber);
  b.block(room.at(x + 0.34f, y + 0.16f, 0.75f), {0.07f, 0.11f, 0.03f}, Material::rubber);
  b.cone(room.at(x - 0.55f, y + 0.1f, 0.75f), {0.04f, 0.1f, 1.0f}, Material::paint, b.newSeed());
  for (int i = 0; i < 3; ++i) {
    b.block(room.at(x - 0.5f + b.random.between(-0.08f, 0.08f), y - 0.15f, 0.75f + 0.03f * static_cast<float>(i)),
            {0.22f, 0.30f, 0.03f}, Material::books, b.newSeed());
  }
}

/// `facing` is the side of the seat, along the room's y, that has the back.
void addChair(SceneBuilder& b, const RoomPlan& room, float x, float y, float facing) {
  const std::uint32_t seed = b.newSeed();
  b.block(room.at(x, y, 0.44f), {0.48f, 0.48f, 0.07f}, Material::fabric, seed);
  b.block(room.at(x, y + facing * 0.24f, 0.56f), {0.44f, 0.05f, 0.5f}, Material::fabric, seed);
  b.block(room.at(x, y + facing * 0.24f, 0.45f), {0.06f, 0.03f, 0.2f}, Material::metal);
  b.cone(room.at(x, y, 0.06f), {0.03f, 0.38f, 1.0f}, Material::metal);
  b.block(room.at(x, y, 0.04f), {0.56f, 0.06f, 0.04f}, Material::rubber);
  b.block(room.at(x, y, 0.04f), {0.06f, 0.56f, 0.04f}, Material::rubber);
}

/// A bookcase from y to y + width, whose back is at x and which faces east (sign 1) or west (sign -1).
struct Bookcase {
  float x, y, width, sign;
};
void addBookcase(SceneBuilder& b, const RoomPlan& room, const Bookcase& bookcase) {
  const auto& [x, y, width, sign] = bookcase;
  constexpr float kDepth = 0.32f, kCaseHeight = 2.2f, kShelf = 0.36f;
  const float front = x + sign * kDepth;
  const float low = room.west + std::min(x, front), high = room.west + std::max(x, front);
  const float y0 = std::min(room.y(y), room.y(y + width)), y1 = y0 + width;
  const float back = room.west + x;
  b.box({std::min(back, back + sign * 0.02f), y0, 0.0f}, {std::max(back, back + sign * 0.02f), y1, kCaseHeight},
        Material::wood, 5);
  for (const float end : {y0, y1 - 0.03f}) b.box({low, end, 0.0f}, {high, end + 0.03f, kCaseHeight}, Material::wood, 5);
  for (int shelf = 0; shelf <= 6; ++shelf) {
    const float z = 0.04f + kShelf * static_cast<float>(shelf) * 0.98f;
    b.box({low, y0, z - 0.03f}, {high, y1, z}, Material::wood, 5);
    if (shelf == 6) break;
    for (float at = y0 + 0.04f; at < y1 - 0.2f;) {  // books in groups of one height
      const float length = std::min(b.random.between(0.12f, 0.34f), y1 - 0.04f - at);
      const float depth = b.random.between(0.17f, 0.26f);
      if (b.random.chance(0.86f)) {
        const float from = back + sign * 0.02f, to = back + sign * depth;
        b.box({std::min(from, to), at, z}, {std::max(from, to), at + length, z + b.random.between(0.21f, 0.31f)},
              Material::books, b.newSeed());
      }
      at += length;
    }
  }
}

void addPlant(SceneBuilder& b, const RoomPlan& room, float x, float y) {
  const std::uint32_t seed = b.newSeed();
  b.cone(room.at(x, y, 0.0f), {0.18f, 0.36f, 1.0f}, Material::brick, seed);
  b.cone(room.at(x, y, 0.36f), {0.025f, 0.5f, 0.6f}, Material::bark, seed);
  for (int i = 0; i < 3; ++i) {
    const float shift = 0.16f * static_cast<float>(i - 1);
    b.foliage(room.at(x + shift, y + b.random.between(-0.12f, 0.12f), 0.95f + 0.16f * static_cast<float>(i % 2)),
              {0.26f, 0.26f, 0.34f}, 0.25f, Material::leaf, seed);
  }
}

void addBin(SceneBuilder& b, const RoomPlan& room, float x, float y) {
  b.cone(room.at(x, y, 0.0f), {0.14f, 0.32f, 1.0f}, Material::metal, 9);
}

/// A flat object on the western (sign 1) or eastern (sign -1) wall.
struct WallPanel {
  float sign, y, z, width, height;
};
void addOnWall(SceneBuilder& b, const RoomPlan& room, const WallPanel& panel, Material material) {
  const auto& [sign, y, z, width, height] = panel;
  const float wall = room.west + (sign > 0.0f ? kWall * 0.5f : kRoomWidth - kWall * 0.5f);
  const float middle = room.y(y);
  b.box({std::min(wall, wall + sign * 0.03f), middle - width * 0.5f, z},
        {std::max(wall, wall + sign * 0.03f), middle + width * 0.5f, z + height}, material, b.newSeed());
}

void furnishOffice(SceneBuilder& b, const RoomPlan& room) {
  for (const float x : {1.25f, 3.55f}) {
    for (const float y : {1.5f, 3.4f}) {
      addDesk(b, room, x, y);
      addChair(b, room, x + b.random.between(-0.2f, 0.2f), y + b.random.between(0.65f, 0.8f), 1.0f);
    }
    addBin(b, room, x + 1.0f, 1.4f);
  }
  addBookcase(b, room, {kRoomWidth - kWall * 0.5f, 4.2f, 1.5f, -1.0f});
  addPlant(b, room, 0.5f, 0.45f);
  addOnWall(b, room, {1.0f, 3.2f, 1.3f, 0.9f, 0.6f}, Material::picture);
}

void furnishMeeting(SceneBuilder& b, const RoomPlan& room) {
  b.block(room.at(2.4f, 2.8f, 0.70f), {1.4f, 3.4f, 0.05f}, Material::wood, 21);
  for (const float y : {1.6f, 4.0f}) b.cone(room.at(2.4f, y, 0.0f), {0.28f, 0.70f, 0.35f}, Material::metal);
  for (int i = 0; i < 4; ++i) {
    const float y = 1.5f + 0.85f * static_cast<float>(i);
    for (const float sign : {-1.0f, 1.0f}) addChair(b, room, 2.4f + sign * 1.05f, y, i % 2 == 0 ? 1.0f : -1.0f);
    b.block(room.at(2.4f + b.random.between(-0.4f, 0.4f), y, 0.75f), {0.21f, 0.30f, 0.01f}, Material::whiteboard,
            b.newSeed());
  }
  b.cone(room.at(2.4f, 2.8f, 0.75f), {0.08f, 0.22f, 0.7f}, Material::glass);
  addOnWall(b, room, {1.0f, 2.8f, 0.9f, 2.4f, 1.3f}, Material::whiteboard);
  addOnWall(b, room, {-1.0f, 2.8f, 1.1f, 1.8f, 1.0f}, Material::screen);
  addPlant(b, room, 4.3f, 0.5f);
}

void furnishLounge(SceneBuilder& b, const RoomPlan& room) {
  const auto sofa = [&](float x, float y, float sign) {
    const std::uint32_t seed = b.newSeed();
    b.block(room.at(x, y, 0.08f), {0.85f, 2.0f, 0.34f}, Material::fabric, seed);
    b.block(room.at(x - sign * 0.36f, y, 0.42f), {0.16f, 2.0f, 0.42f}, Material::fabric, seed);
    for (const float end : {-0.92f, 0.92f})
      b.block(room.at(x, y + end, 0.42f), {0.85f, 0.16f, 0.2f}, Material::fabric, seed);
    b.block(room.at(x - sign * 0.1f, y + 0.6f, 0.42f), {0.14f, 0.4f, 0.36f}, Material::awning, seed + 1);
  };
  sofa(0.65f, 2.2f, 1.0f);
  sofa(3.2f, 2.2f, -1.0f);
  b.block(room.at(1.9f, 2.2f, 0.38f), {0.7f, 1.2f, 0.04f}, Material::wood, 31);
  for (const float y : {1.75f, 2.65f}) b.block(room.at(1.9f, y, 0.0f), {0.5f, 0.05f, 0.38f}, Material::wood, 31);
  b.block(room.at(1.85f, 2.1f, 0.42f), {0.3f, 0.22f, 0.02f}, Material::books, b.newSeed());
  b.cone(room.at(4.2f, 0.5f, 0.0f), {0.02f, 1.5f, 1.0f}, Material::metal);  // floor lamp
  b.cone(room.at(4.2f, 0.5f, 1.4f), {0.22f, 0.3f, 0.6f}, Material::lamp);
  // Kitchenette along the eastern wall.
  b.box({room.west + 4.15f, std::min(room.y(3.6f), room.y(5.9f)), 0.0f},
        {room.west + 4.7f, std::max(room.y(3.6f), room.y(5.9f)), 0.9f}, Material::paint, 6);
  b.box({room.west + 4.10f, std::min(room.y(3.6f), room.y(5.9f)), 0.9f},
        {room.west + 4.7f, std::max(room.y(3.6f), room.y(5.9f)), 0.94f}, Material::wood, 33);
  b.box({room.west + 4.35f, std::min(room.y(3.6f), room.y(5.9f)), 1.5f},
        {room.west + 4.7f, std::max(room.y(3.6f), room.y(5.9f)), 2.2f}, Material::paint, 6);
  b.block(room.at(4.45f, 4.2f, 0.94f), {0.3f, 0.4f, 0.35f}, Material::metal);
  addOnWall(b, room, {1.0f, 4.2f, 1.2f, 1.1f, 0.8f}, Material::picture);
  addPlant(b, room, 0.5f, 0.5f);
}

void furnishLibrary(SceneBuilder& b, const RoomPlan& room) {
  addBookcase(b, room, {kWall * 0.5f, 0.5f, 3.4f, 1.0f});
  addBookcase(b, room, {kRoomWidth - kWall * 0.5f, 0.5f, 5.0f, -1.0f});
  addBookcase(b, room, {2.0f, 0.8f, 2.2f, 1.0f});
  b.block(room.at(2.6f, 4.4f, 0.70f), {1.2f, 1.2f, 0.04f}, Material::wood, 41);
  b.cone(room.at(2.6f, 4.4f, 0.0f), {0.3f, 0.70f, 0.3f}, Material::wood, 41);
  for (const float y : {3.6f, 5.2f}) addChair(b, room, 2.6f, y, y < 4.0f ? -1.0f : 1.0f);
  b.block(room.at(2.7f, 4.3f, 0.74f), {0.3f, 0.22f, 0.04f}, Material::books, b.newSeed());
  addPlant(b, room, 1.4f, 0.5f);
}

/// Wall with a door opening between a room and the corridor, and the open door.
void addDoorWall(SceneBuilder& b, const RoomPlan& room, std::uint32_t seed) {
  const float low = room.north ? kCorridorHigh : kRoomDepth, high = low + kWall;
  const float east = room.west + kRoomWidth;
  b.box({room.west, low, 0.0f}, {room.west + kDoorFrom, high, kHeight}, Material::wall, seed);
  b.box({room.west + kDoorTo, low, 0.0f}, {east, high, kHeight}, Material::wall, seed);
  b.box({room.west + kDoorFrom, low, kDoorHeight}, {room.west + kDoorTo, high, kHeight}, Material::wall, seed);
  for (const float x : {kDoorFrom - 0.05f, kDoorTo - 0.01f}) {  // frame
    b.box({room.west + x, low - 0.02f, 0.0f}, {room.west + x + 0.06f, high + 0.02f, kDoorHeight}, Material::metal);
  }
  const float hinge = room.west + kDoorFrom + 0.02f, leaf = room.y(kRoomDepth - 0.95f), wall = room.y(kRoomDepth);
  b.box({hinge, std::min(leaf, wall), 0.01f}, {hinge + 0.045f, std::max(leaf, wall), kDoorHeight - 0.02f},
        Material::wood, seed);
  b.ball({hinge + 0.09f, room.y(kRoomDepth - 0.85f), 1.02f}, {0.04f, 0.04f, 0.04f}, Material::metal);
}

void addRoomShell(SceneBuilder& b, const RoomPlan& room) {
  const std::uint32_t seed = b.newSeed();
  addDoorWall(b, room, seed);
  const float low = std::min(room.y(0.0f), room.y(kRoomDepth)), high = low + kRoomDepth;
  b.box({room.west + kWall * 0.5f, low, -0.05f}, {room.west + kRoomWidth - kWall * 0.5f, high, 0.006f},
        Material::carpet, seed);
  for (const float x : {1.2f, 3.6f}) {
    for (const float y : {2.0f, 4.5f}) b.block(room.at(x, y, kHeight - 0.04f), {1.2f, 0.3f, 0.05f}, Material::lamp);
    b.block(room.at(x, 0.14f, 0.1f), {1.5f, 0.12f, 0.55f}, Material::paint, 12);  // radiator under the window
  }
}

void addCorridor(SceneBuilder& b, float length, int columns) {
  const float middle = (kCorridorLow + kCorridorHigh) * 0.5f;
  for (int i = 0; i < columns; ++i) {
    const float west = static_cast<float>(i) * kRoomWidth;
    for (const float x : {1.2f, 3.6f})
      b.block({west + x, middle, kHeight - 0.04f}, {1.2f, 0.3f, 0.05f}, Material::lamp);
    b.box({west + 2.6f, kCorridorLow, 1.3f}, {west + 3.6f, kCorridorLow + 0.03f, 2.0f}, Material::picture, b.newSeed());
    if (i % 2 == 1)
      b.block({west + 3.4f, kCorridorHigh - 0.25f, 0.0f}, {1.0f, 0.4f, 0.45f}, Material::fabric, b.newSeed());
  }
  b.box({length - 0.03f, middle - 0.6f, 0.8f}, {length, middle + 0.6f, 2.2f}, Material::picture, b.newSeed());
  b.box({0.0f, middle - 0.5f, 0.0f}, {0.04f, middle + 0.5f, kDoorHeight}, Material::wood, 8);
}

void addShell(SceneBuilder& b, float length, int columns) {
  b.box({0.0f, -kOuterWall, 0.0f}, {length, 0.0f, kHeight}, Material::officeWall).windowSides = side::kNorth;
  b.box({0.0f, kNorthHigh, 0.0f}, {length, kNorthHigh + kOuterWall, kHeight}, Material::officeWall).windowSides =
      side::kSouth;
  b.box({-kOuterWall, -kOuterWall, 0.0f}, {0.0f, kNorthHigh + kOuterWall, kHeight}, Material::wall);
  b.box({length, -kOuterWall, 0.0f}, {length + kOuterWall, kNorthHigh + kOuterWall, kHeight}, Material::wall);
  b.box({-kOuterWall, -kOuterWall, kHeight}, {length + kOuterWall, kNorthHigh + kOuterWall, kHeight + 0.2f},
        Material::ceiling);
  for (int i = 1; i < columns; ++i) {  // partitions
    const float x = static_cast<float>(i) * kRoomWidth;
    for (const float low : {0.0f, kNorthLow}) {
      b.box({x - kWall * 0.5f, low, 0.0f}, {x + kWall * 0.5f, low + kRoomDepth, kHeight}, Material::wall,
            static_cast<std::uint32_t>(i));
    }
  }
}

std::vector<Station> stationsFor(const Scene& scene, int columns) {
  Station tripod;
  tripod.highest = 1.5f;
  tripod.reach = 80.0f;
  std::vector<Station> stations;
  const auto add = [&](const glm::vec3& position) {  // beside the furniture, as near as a tripod can stand
    for (int ring = 0; ring < 9; ++ring) {
      for (int turn = 0; turn < 8; ++turn) {
        const float angle = 0.7854f * static_cast<float>(turn), radius = 0.2f * static_cast<float>(ring);
        tripod.position = position + glm::vec3(radius * std::cos(angle), radius * std::sin(angle), 0.0f);
        const glm::vec3 legs(tripod.position.x, tripod.position.y, 0.5f);
        if (scene.isFree(tripod.position, 0.25f) && scene.isFree(legs, 0.25f)) return stations.push_back(tripod);
      }
    }
  };
  for (int i = 0; i < columns; ++i) {
    for (const bool north : {false, true}) {  // one near the door, one near the window
      const RoomPlan room{static_cast<float>(i) * kRoomWidth, north};
      add(room.at(2.6f, 4.9f, kTripodM));
      add(room.at(2.3f, 1.0f, kTripodM));
    }
    if (i % 2 == 0) add({(static_cast<float>(i) + 0.6f) * kRoomWidth, (kCorridorLow + kCorridorHigh) * 0.5f, kTripodM});
  }
  return stations;
}

}  // namespace

std::unique_ptr<ScannerScan> makeRoom(std::uint64_t points, std::uint64_t seed) {
  int columns = 4;  // two more for ten times the points
  for (std::uint64_t limit = 3'000'000; points > limit && columns < 10; limit *= 10) columns += 2;
  const float length = static_cast<float>(columns) * kRoomWidth;
  SceneBuilder b(seed ^ 0x0ff1ce);
  addShell(b, length, columns);
  addCorridor(b, length, columns);
  for (int i = 0; i < 2 * columns; ++i) {
    const RoomPlan room{static_cast<float>(i / 2) * kRoomWidth, i % 2 == 1};
    addRoomShell(b, room);
    switch ((i + b.random.below(2)) % 5) {
      case 0:
        furnishMeeting(b, room);
        break;
      case 1:
        furnishLibrary(b, room);
        break;
      case 2:
        furnishLounge(b, room);
        break;
      default:
        furnishOffice(b, room);
        break;
    }
  }
  Scene scene(std::move(b.primitives), glm::vec2(-kOuterWall), {length + kOuterWall, kNorthHigh + kOuterWall}, kCellM);
  ShapeExtent extent;
  constexpr double kMargin = 0.02;  // more than the noise of the range
  extent.min = {-static_cast<double>(kOuterWall), -static_cast<double>(kOuterWall), -kMargin};
  extent.max = {static_cast<double>(length + kOuterWall), static_cast<double>(kNorthHigh + kOuterWall),
                static_cast<double>(kHeight) + kMargin};
  Lighting lighting;
  lighting.indoor = true;
  lighting.lampPitch = kRoomWidth * 0.5f;
  lighting.lampHeight = kHeight - 0.05f;
  lighting.lampRows = {2.0f, 4.5f, (kCorridorLow + kCorridorHigh) * 0.5f, kNorthHigh - 4.5f, kNorthHigh - 2.0f};
  std::vector<Station> stations = stationsFor(scene, columns);
  return std::make_unique<ScannerScan>(
      ScannedScene{std::move(scene), Material::parquet, std::move(lighting), std::move(stations), extent}, points,
      seed);
}

}  // namespace strata::synthetic
