// SPDX-License-Identifier: Apache-2.0
#include "scene/load.hpp"

#include "mebots/data/document.hpp"
#include "mebots/data/object.hpp"

#include <fmt/format.h>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

namespace mebots::world::scene {
namespace {

using data::Limits;
using data::Node;
using data::number;
using data::Object;
using data::quantity;

const Limits kUnit = Limits::between(0.0, 1.0);
const Limits kGrey = Limits::between(0.0, 255.0);

template <int Size>
auto vector(const Limits& limits = {}) {
  return [limits](const Node& node) {
    const auto values = data::read_numbers(node, limits);
    if (node.elements().size() != Size) {
      node.fail(ErrorCode::invalid_value,
                fmt::format("{} numbers are needed here, not {}", Size, node.elements().size()));
    }
    Eigen::Matrix<double, Size, 1> vector = Eigen::Matrix<double, Size, 1>::Zero();
    if (values.size() == Size) vector = Eigen::Matrix<double, Size, 1>(values.data());
    return vector;
  };
}

/// The values of {"values": [x, y, z], "unit": text, "source": text}.
auto sourced_vector(std::string_view unit, const Limits& limits) {
  return [=](const Node& node) {
    Object object(node);
    Eigen::Vector3d values = Eigen::Vector3d::Zero();
    object.read("values", values, vector<3>(limits));
    data::read_unit(object, unit);
    data::read_source(object);
    object.finish();
    return values;
  };
}

Texture read_texture(const Node& node) {
  static const auto kind = data::word_of<Texture::Kind>({{"uniform", Texture::Kind::uniform},
                                                         {"checker", Texture::Kind::checker},
                                                         {"stripes", Texture::Kind::stripes},
                                                         {"noise", Texture::Kind::noise},
                                                         {"bricks", Texture::Kind::bricks}});
  Object object(node);
  Texture texture;
  object.read("kind", texture.kind, kind);
  object.read("light", texture.light, number(kGrey));
  texture.dark = texture.light;
  object.read_if("dark", texture.dark, number(kGrey));
  object.read_if("scale", texture.scale_m, number(Limits::positive()));
  object.read_if("seed", texture.seed, data::whole_number(0, std::numeric_limits<std::uint32_t>::max()));
  object.finish();
  return texture;
}

Ground read_ground(const Node& node) {
  Object object(node);
  Ground ground;
  object.read("half_size", ground.half_size_m, number(Limits::positive()));
  object.read("texture", ground.texture, &read_texture);
  object.finish();
  return ground;
}

Box read_box(const Node& node) {
  Object object(node);
  Box box;
  object.read("name", box.name, &Node::text);
  object.read("position", box.p_W_m, vector<3>());
  object.read("size", box.size_m, vector<3>(Limits::positive()));
  object.read_if("yaw", box.yaw_rad, number());
  object.read("texture", box.texture, &read_texture);
  object.finish();
  return box;
}

Gate read_gate(const Node& node) {
  Object object(node);
  Gate gate;
  object.read("name", gate.name, &Node::text);
  object.read_if("inner", gate.inner_m, number(Limits::positive()));
  object.read_if("outer", gate.outer_m, number(Limits::positive()));
  object.read_if("thickness", gate.thickness_m, number(Limits::positive()));
  if (object.sound() && gate.outer_m <= gate.inner_m) {
    const auto wrong = node.find("outer").value_or(node.find("inner").value_or(node));
    wrong.complain(ErrorCode::invalid_value,
                   fmt::format("outer = {} must be greater than inner = {}", gate.outer_m, gate.inner_m));
  }
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double lower_edge_m = 0;
  object.read("position", place, vector<2>());
  const double border_m = 0.5 * (gate.outer_m - gate.inner_m);
  object.read("opening_lower_edge", lower_edge_m, number(Limits::at_least(border_m)));
  gate.p_W_m = {place[0], place[1], lower_edge_m + 0.5 * gate.inner_m};
  object.read_if("yaw", gate.yaw_rad, number());
  object.read("texture", gate.texture, &read_texture);
  object.finish();
  return gate;
}

Lighting read_lighting(const Node& node) {
  Object object(node);
  Lighting lighting;
  object.read("ambient", lighting.ambient, number(Limits::at_least(0.0)));
  object.read("sun", lighting.sun, number(Limits::at_least(0.0)));
  object.read("to_sun", lighting.to_sun_W, [](const Node& member) {
    const Eigen::Vector3d to_sun = vector<3>()(member);
    if (to_sun.norm() < 1e-9) member.fail(ErrorCode::invalid_value, "this must not be the zero vector");
    return Eigen::Vector3d(to_sun.normalized());
  });
  object.read("background", lighting.background, number(kGrey));
  object.finish();
  return lighting;
}

StartPose read_start(const Node& node) {
  Object object(node);
  StartPose start;
  object.read("position", start.p_WB_m, vector<3>());
  object.read_if("yaw", start.yaw_rad, number());
  object.finish();
  return start;
}

Contact read_contact(const Node& node) {
  Object object(node);
  Contact contact;
  object.read("friction", contact.friction, number(Limits::at_least(0.0)));
  object.read("bounce", contact.bounce, number(kUnit));
  object.read("bounce_speed", contact.bounce_speed_m_per_s, number(Limits::at_least(0.0)));
  object.read("soft_erp", contact.soft_erp, number(kUnit));
  object.read("soft_cfm", contact.soft_cfm, number(Limits::at_least(0.0)));
  object.read("erp", contact.erp, number(kUnit));
  object.read("cfm", contact.cfm, number(Limits::at_least(0.0)));
  object.read("crash_speed", contact.crash_speed_m_per_s, number(Limits::positive()));
  object.read("crash_tilt", contact.crash_tilt_rad, number({0.0, 3.1416, false}));
  object.comment("source");
  object.finish();
  return contact;
}

std::vector<ThrustPoint> read_thrust_curve(const Node& node) {
  Object object(node);
  std::vector<double> command;
  std::vector<double> thrust;
  data::read_unit(object, "N");
  object.comment("source");
  object.read("command", command, data::rising_numbers(kUnit));
  object.read("thrust", thrust, data::rising_numbers(Limits::at_least(0.0)));
  object.finish();
  std::vector<ThrustPoint> curve;
  if (!object.sound()) return curve;
  if (command.size() < 2) node.at("command").complain(ErrorCode::invalid_value, "two numbers are the least");
  if (thrust.size() != command.size()) {
    node.at("thrust").fail(ErrorCode::invalid_value, fmt::format("{} numbers for {} of command; each needs its own",
                                                                 thrust.size(), command.size()));
  }
  if (command[0] != 0.0 || thrust[0] != 0.0) {
    node.at("command").complain(ErrorCode::invalid_value, "command and thrust must both begin with 0");
  }
  for (std::size_t i = 0; i < command.size(); ++i) curve.push_back({command[i], thrust[i]});
  return curve;
}

/// A body's largest moment of inertia is at most the sum of the other two.
Eigen::Vector3d read_inertia(const Node& node) {
  Eigen::Vector3d j = sourced_vector("kg.m2", Limits::positive())(node);
  if (2.0 * j.maxCoeff() > j.sum()) {
    node.fail(ErrorCode::invalid_value,
              fmt::format("[{}, {}, {}] is not any body's: each moment is at most the sum of the other two", j.x(),
                          j.y(), j.z()));
  }
  return j;
}

Drone read_drone(const Node& node) {
  const auto positive = Limits::positive();
  Object object(node);
  Drone drone;
  object.comment("$schema");
  object.read("name", drone.name, &Node::text);
  object.read("body_size", drone.body_size_m, sourced_vector("m", positive));
  object.read("reference_mass", drone.reference_mass_kg, quantity("kg", positive));
  object.read("inertia", drone.inertia_kg_m2, &read_inertia);
  object.read("load_size", drone.load_size_m, sourced_vector("m", positive));
  object.read("arm", drone.arm_m, quantity("m", positive));
  object.read("drag", drone.drag_n_s_per_m, sourced_vector("N.s/m", Limits::at_least(0.0)));
  object.read("torque_per_thrust", drone.torque_per_thrust_m, quantity("m", positive));
  object.read("rotor_lag", drone.rotor_lag_s, quantity("s", Limits::at_least(0.0)));
  object.read("range_limit", drone.range_limit_m, quantity("m", positive));
  object.read("thrust_curve", drone.thrust_curve, &read_thrust_curve);
  object.finish();
  return drone;
}

Scene read_scene(const Node& node, const std::filesystem::path& folder) {
  Object object(node);
  Scene scene;
  object.comment("$schema");
  object.read("name", scene.name, &Node::text);
  object.read("text", scene.text, &Node::text);
  object.read("drone", scene.drone,
              [&](const Node& member) { return load_drone((folder / member.text()).lexically_normal()); });
  object.read("start", scene.start, &read_start);
  object.read("ground", scene.ground, &read_ground);
  object.read("boxes", scene.boxes, data::list_of(&read_box));
  object.read("gates", scene.gates, data::list_of(&read_gate));
  object.read("lighting", scene.lighting, &read_lighting);
  object.read("contact", scene.contact, &read_contact);
  object.finish();
  return scene;
}

}  // namespace

Drone load_drone(const std::filesystem::path& file) {
  return data::Document(file).read(&read_drone);
}

Scene load_scene(const std::filesystem::path& file) {
  return data::Document(file).read([&](const Node& root) { return read_scene(root, file.parent_path()); });
}

}  // namespace mebots::world::scene
