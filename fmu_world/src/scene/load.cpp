// SPDX-License-Identifier: Apache-2.0
#include "scene/load.hpp"

#include "mebots/data_file.hpp"

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace mebots::world::scene {
namespace {

using data::Limits;
using data::Node;

const Limits kUnit = Limits::between(0.0, 1.0);
const Limits kGrey = Limits::between(0.0, 255.0);

double number_or(const Node& node, std::string_view key, double otherwise, const Limits& limits = {}) {
  return node.has(key) ? node.number(key, limits) : otherwise;
}

std::vector<double> numbers(const Node& node, std::string_view key, std::size_t count, const Limits& limits = {}) {
  auto values = node.numbers(key, limits);
  if (values.size() != count) node.fail(key, fmt::format("has {} numbers; {} are needed", values.size(), count));
  return values;
}

Eigen::Vector3d vector3(const Node& node, std::string_view key, const Limits& limits = {}) {
  return Eigen::Vector3d(numbers(node, key, 3, limits).data());
}

/// The values of {"values": [x, y, z], "unit": text, "source": text}.
Eigen::Vector3d sourced_vector3(const Node& node, std::string_view key, std::string_view unit, const Limits& limits) {
  const Node quantity = node.object(key);
  quantity.only({"values", "unit", "source"}).require_unit(unit);
  if (quantity.text("source").empty()) quantity.fail("source", "is empty: say where the values come from");
  return vector3(quantity, "values", limits);
}

std::uint32_t read_seed(const Node& node) {
  if (!node.has("seed")) return 0;
  const double seed = node.number("seed", Limits::between(0.0, 4294967295.0));
  if (seed != std::floor(seed)) node.fail("seed", fmt::format("= {} must be a whole number", seed));
  return static_cast<std::uint32_t>(seed);
}

Texture read_texture(const Node& node) {
  constexpr std::array<std::pair<std::string_view, Texture::Kind>, 5> kinds{{{"uniform", Texture::Kind::uniform},
                                                                             {"checker", Texture::Kind::checker},
                                                                             {"stripes", Texture::Kind::stripes},
                                                                             {"noise", Texture::Kind::noise},
                                                                             {"bricks", Texture::Kind::bricks}}};
  node.only({"kind", "light", "dark", "scale", "seed"});
  const std::string wanted = node.text("kind");
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.first == wanted; });
  if (kind == kinds.end()) {
    node.fail("kind", fmt::format("= \"{}\" must be uniform, checker, stripes, noise or bricks", wanted));
  }
  Texture texture;
  texture.kind = kind->second;
  texture.light = node.number("light", kGrey);
  texture.dark = number_or(node, "dark", texture.light, kGrey);
  texture.scale_m = number_or(node, "scale", texture.scale_m, Limits::positive());
  texture.seed = read_seed(node);
  return texture;
}

Ground read_ground(const Node& node) {
  node.only({"half_size", "texture"});
  return {node.number("half_size", Limits::positive()), read_texture(node.object("texture"))};
}

Box read_box(const Node& node) {
  node.only({"name", "position", "size", "yaw", "texture"});
  return {node.text("name"), vector3(node, "position"), vector3(node, "size", Limits::positive()),
          number_or(node, "yaw", 0.0), read_texture(node.object("texture"))};
}

Gate read_gate(const Node& node) {
  node.only({"name", "position", "opening_lower_edge", "yaw", "inner", "outer", "thickness", "texture"});
  Gate gate;
  gate.name = node.text("name");
  gate.inner_m = number_or(node, "inner", gate.inner_m, Limits::positive());
  gate.outer_m = number_or(node, "outer", gate.outer_m, Limits::positive());
  if (gate.outer_m <= gate.inner_m) {
    node.fail("outer", fmt::format("= {} must be greater than inner = {}", gate.outer_m, gate.inner_m));
  }
  gate.thickness_m = number_or(node, "thickness", gate.thickness_m, Limits::positive());
  const auto place = numbers(node, "position", 2);
  const double border_m = 0.5 * (gate.outer_m - gate.inner_m);
  const double lower_edge_m = node.number("opening_lower_edge", Limits::at_least(border_m));
  gate.p_W_m = {place[0], place[1], lower_edge_m + 0.5 * gate.inner_m};
  gate.yaw_rad = number_or(node, "yaw", 0.0);
  gate.texture = read_texture(node.object("texture"));
  return gate;
}

Lighting read_lighting(const Node& node) {
  node.only({"ambient", "sun", "to_sun", "background"});
  Lighting lighting;
  lighting.ambient = node.number("ambient", Limits::at_least(0.0));
  lighting.sun = node.number("sun", Limits::at_least(0.0));
  lighting.to_sun_W = vector3(node, "to_sun");
  if (lighting.to_sun_W.norm() < 1e-9) node.fail("to_sun", "must not be the zero vector");
  lighting.to_sun_W.normalize();
  lighting.background = node.number("background", kGrey);
  return lighting;
}

StartPose read_start(const Node& node) {
  node.only({"position", "yaw"});
  return {vector3(node, "position"), number_or(node, "yaw", 0.0)};
}

Contact read_contact(const Node& node) {
  node.only({"friction", "bounce", "bounce_speed", "soft_erp", "soft_cfm", "erp", "cfm", "crash_speed", "crash_tilt",
             "source"});
  Contact contact;
  contact.friction = node.number("friction", Limits::at_least(0.0));
  contact.bounce = node.number("bounce", kUnit);
  contact.bounce_speed_m_per_s = node.number("bounce_speed", Limits::at_least(0.0));
  contact.soft_erp = node.number("soft_erp", kUnit);
  contact.soft_cfm = node.number("soft_cfm", Limits::at_least(0.0));
  contact.erp = node.number("erp", kUnit);
  contact.cfm = node.number("cfm", Limits::at_least(0.0));
  contact.crash_speed_m_per_s = node.number("crash_speed", Limits::positive());
  contact.crash_tilt_rad = node.number("crash_tilt", {0.0, 3.1416, false});
  return contact;
}

std::vector<ThrustPoint> read_thrust_curve(const Node& node) {
  node.only({"command", "thrust", "unit", "source"}).require_unit("N");
  const auto command = node.rising_numbers("command", kUnit);
  const auto thrust = node.rising_numbers("thrust", Limits::at_least(0.0));
  if (command.size() < 2) node.fail("command", "needs at least two numbers");
  if (thrust.size() != command.size()) {
    node.fail("thrust",
              fmt::format("has {} numbers; {} are needed, one for each command", thrust.size(), command.size()));
  }
  if (command[0] != 0.0 || thrust[0] != 0.0) node.fail("command", "and thrust must both begin with 0");
  std::vector<ThrustPoint> curve;
  for (std::size_t i = 0; i < command.size(); ++i) curve.push_back({command[i], thrust[i]});
  return curve;
}

Drone read_drone(const Node& node) {
  node.only({"name", "body_size", "reference_mass", "inertia", "load_size", "arm", "drag", "torque_per_thrust",
             "rotor_lag", "range_limit", "thrust_curve"});
  Drone drone;
  drone.name = node.text("name");
  drone.body_size_m = sourced_vector3(node, "body_size", "m", Limits::positive());
  drone.reference_mass_kg = node.quantity("reference_mass", "kg", Limits::positive());
  drone.inertia_kg_m2 = sourced_vector3(node, "inertia", "kg.m2", Limits::positive());
  const Eigen::Vector3d& j = drone.inertia_kg_m2;
  if (2.0 * j.maxCoeff() > j.sum()) {
    node.fail("inertia", fmt::format("= [{}, {}, {}] is no body's: each moment is at most the sum of the other two",
                                     j.x(), j.y(), j.z()));
  }
  drone.load_size_m = sourced_vector3(node, "load_size", "m", Limits::positive());
  drone.arm_m = node.quantity("arm", "m", Limits::positive());
  drone.drag_n_s_per_m = sourced_vector3(node, "drag", "N.s/m", Limits::at_least(0.0));
  drone.torque_per_thrust_m = node.quantity("torque_per_thrust", "m", Limits::positive());
  drone.rotor_lag_s = node.quantity("rotor_lag", "s", Limits::at_least(0.0));
  drone.range_limit_m = node.quantity("range_limit", "m", Limits::positive());
  drone.thrust_curve = read_thrust_curve(node.object("thrust_curve"));
  return drone;
}

}  // namespace

Drone load_drone(const std::filesystem::path& file) {
  const data::File source(file);
  return read_drone(source.root());
}

Scene load_scene(const std::filesystem::path& file) {
  const data::File source(file);
  const Node node = source.root();
  node.only({"name", "text", "drone", "start", "ground", "boxes", "gates", "lighting", "contact"});
  Scene scene;
  scene.name = node.text("name");
  scene.text = node.text("text");
  scene.drone = load_drone((file.parent_path() / node.text("drone")).lexically_normal());
  scene.start = read_start(node.object("start"));
  scene.ground = read_ground(node.object("ground"));
  for (const Node& box : node.objects("boxes")) scene.boxes.push_back(read_box(box));
  for (const Node& gate : node.objects("gates")) scene.gates.push_back(read_gate(gate));
  scene.lighting = read_lighting(node.object("lighting"));
  scene.contact = read_contact(node.object("contact"));
  return scene;
}

}  // namespace mebots::world::scene
