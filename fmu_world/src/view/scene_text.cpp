// SPDX-License-Identifier: Apache-2.0
#include "view/scene_text.hpp"

#include "camera/geometry.hpp"
#include "mebots/base64.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace mebots::world {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json texture_json(const camera::Tile& tile) {
  const int size = tile.ripmap.size();
  std::vector<std::uint8_t> grey;
  grey.reserve(static_cast<std::size_t>(size) * size);
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      grey.push_back(static_cast<std::uint8_t>(tile.ripmap.texel(0, 0, column, row)));
    }
  }
  return {{"size", size}, {"grey", encode_base64(grey)}};
}

/// Returns a face with its corners and their texture coordinates (u, v) in tiles.
Json face_json(const camera::Face& face, const camera::Tile& tile) {
  Json corners = Json::array();
  Json coordinates = Json::array();
  for (const auto& corner : face.corners_W_m) {
    const Eigen::Vector3d from_origin = corner - face.texture_origin_W_m;
    corners.push_back(json_of(corner));
    coordinates.push_back({(face.u_axis_W.dot(from_origin) + face.u_origin_m) / tile.edge_u_m,
                           (face.v_axis_W.dot(from_origin) + face.v_origin_m) / tile.edge_v_m});
  }
  Json json = {{"corners", corners},
               {"normal", json_of(face.normal_W)},
               {"texture_coordinates", coordinates},
               {"texture", face.tile},
               {"light", face.light}};
  if (face.mover != camera::Face::kStatic) json["mover"] = face.mover;
  return json;
}

/// Returns the JSON of a robot's motion. It names the FMU's outputs that contain the robot's position and heading.
Json robot_json(std::size_t robot) {
  const std::string name = "robot[" + std::to_string(robot + 1) + "].";
  return {{"origin", json_of(Eigen::Vector3d::Zero())},
          {"position", {name + "place.x", name + "place.y", name + "place.z"}},
          {"yaw", name + "heading"}};
}

Json mover_json(const camera::Mover& mover) {
  if (mover.body != camera::Mover::kNoBody) return robot_json(mover.body);
  Json points = Json::array();
  for (const auto& point : mover.path.points) {
    points.push_back({{"time", static_cast<double>(point.time_ns) * 1e-9},
                      {"offset", json_of(point.offset_W_m)},
                      {"turn", point.turn_rad}});
  }
  return {{"origin", json_of(mover.origin_W_m)}, {"repeat", mover.path.repeat}, {"points", points}};
}

/// Returns the rotors in the FMU's order: front right, rear right, rear left, front left. The first and the third turn
/// counter-clockwise.
Json rotors_json(const scene::Drone& drone, const std::string& prefix) {
  constexpr std::array<std::pair<int, int>, 4> kSides{{{1, -1}, {-1, -1}, {-1, 1}, {1, 1}}};
  Json rotors = Json::array();
  for (std::size_t i = 0; i < kSides.size(); ++i) {
    const auto [x, y] = kSides[i];
    rotors.push_back({{"position", {x * drone.arm_m, y * drone.arm_m, drone.body_size_m.z() / 2}},
                      {"radius", camera::kRotorRadiusOverArm * drone.arm_m},
                      {"sense", i % 2 == 0 ? 1 : -1},
                      {"command", prefix + "rotor[" + std::to_string(i + 1) + "].command"}});
  }
  return rotors;
}

Json body_json(const ViewedDrone& viewed) {
  const auto& [drone, intrinsics, mounting, name] = viewed;
  const std::string prefix = name.empty() ? "" : name + ".";
  const std::string own = name.empty() ? "drone." : prefix;
  Json body;
  body["name"] = name.empty() ? drone.name : name;
  body["size"] = json_of(drone.body_size_m);
  body["position"] = {own + "position.x", own + "position.y", own + "position.z"};
  body["attitude"] = {own + "roll", own + "pitch", own + "yaw"};
  body["rotors"] = rotors_json(drone, prefix);
  body["camera"] = {{"position", json_of(mounting.p_BC_m)},
                    {"pitch", mounting.pitch_rad},
                    {"field_of_view", intrinsics.horizontal_field_of_view_rad},
                    {"width", intrinsics.width},
                    {"height", intrinsics.height}};
  body["colours"] = Json::array({{{"variable", own + "speed"}, {"label", "speed"}}});
  return body;
}

}  // namespace

std::string scene_text(const scene::Scene& scene, const std::vector<ViewedDrone>& drones, std::size_t robots) {
  auto geometry = camera::make_geometry(scene);
  for (std::size_t i = 0; i < robots; ++i) camera::add_robot(geometry, *scene.robot, i);
  Json json;
  json["format"] = 1;
  json["name"] = scene.name;
  json["background"] = geometry.background;
  for (const auto& tile : geometry.tiles) json["textures"].push_back(texture_json(*tile));
  for (const auto& face : geometry.faces) json["faces"].push_back(face_json(face, *geometry.tiles[face.tile]));
  if (!geometry.movers.empty()) {
    for (const auto& mover : geometry.movers) json["movers"].push_back(mover_json(mover));
    const auto& lighting = geometry.lighting;
    json["lighting"] = {{"ambient", lighting.ambient}, {"sun", lighting.sun}, {"to_sun", json_of(lighting.to_sun_W)}};
  }
  json["labels"] = Json::array();
  for (const auto& gate : scene.gates) {
    json["labels"].push_back(
        {{"text", gate.name}, {"position", json_of(gate.p_W_m + Eigen::Vector3d(0, 0, 0.5 * gate.frame_height_m()))}});
  }
  json["bodies"] = Json::array();
  for (const auto& drone : drones) json["bodies"].push_back(body_json(drone));
  return json.dump();
}

}  // namespace mebots::world
