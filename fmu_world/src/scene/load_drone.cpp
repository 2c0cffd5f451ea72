// SPDX-License-Identifier: Apache-2.0
#include "mebots/data/document.hpp"
#include "mebots/data/estimate.hpp"
#include "mebots/data/object.hpp"
#include "scene/load.hpp"
#include "scene/read_sensors.hpp"
#include "scene/vector_reader.hpp"

#include <fmt/format.h>
#include <string_view>
#include <vector>

namespace mebots::world::scene {
namespace {

using data::Limits;
using data::Node;
using data::Object;
using data::quantity;

std::vector<ThrustPoint> read_thrust_curve(const Node& node) {
  Object object(node);
  std::vector<double> command;
  std::vector<double> thrust;
  data::read_unit(object, "N");
  object.comment("source");
  object.comment("fitted_on");
  object.read("command", command, data::rising_numbers(Limits::between(0.0, 1.0)));
  object.read("thrust", thrust, data::rising_numbers(Limits::at_least(0.0)));
  object.finish();
  std::vector<ThrustPoint> curve;
  if (!object.sound()) return curve;
  if (command.size() < 2) node.at("command").complain(ErrorCode::invalid_value, "at least two numbers are needed");
  if (thrust.size() != command.size()) {
    node.at("thrust").fail(ErrorCode::invalid_value,
                           fmt::format("there are {} numbers here, but {} in command", thrust.size(), command.size()));
  }
  if (command[0] != 0.0 || thrust[0] != 0.0) {
    node.at("command").complain(ErrorCode::invalid_value, "command and thrust must both begin with 0");
  }
  for (std::size_t i = 0; i < command.size(); ++i) curve.push_back({command[i], thrust[i]});
  return curve;
}

/// Reads the moments of inertia. The largest moment of a body is at most the sum of the other two.
Eigen::Vector3d read_inertia(const Node& node) {
  Eigen::Vector3d j = sourced_vector("kg.m2", Limits::positive())(node);
  if (2.0 * j.maxCoeff() > j.sum()) {
    node.fail(
        ErrorCode::invalid_value,
        fmt::format("[{}, {}, {}] is impossible for a rigid body: each moment is at most the sum of the other two",
                    j.x(), j.y(), j.z()));
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
  object.read_if("drag_factor", drone.drag_factor, data::estimate("1", positive));
  object.read_if("dry_mass_factor", drone.dry_mass_factor, data::estimate("1", positive));
  object.read("torque_per_thrust", drone.torque_per_thrust_m, quantity("m", positive));
  object.read("rotor_lag", drone.rotor_lag_s, quantity("s", Limits::at_least(0.0)));
  object.read_if("start_command", drone.start_command, quantity("1", {0.0, 1.0, false}));
  object.read_if("start_time", drone.start_time_s, quantity("s", Limits::at_least(0.0)));
  object.read("range_limit", drone.range_limit_m, quantity("m", positive));
  object.read("thrust_curve", drone.thrust_curve, &read_thrust_curve);
  object.visit_if("range_sensor", [&](const Node& section) { drone.range = read_range(section); });
  object.visit_if("flow_sensor", [&](const Node& section) { drone.flow = read_flow(section); });
  object.visit_if("multiranger", [&](const Node& section) { drone.multiranger = read_multiranger(section); });
  object.visit_if("barometer", [&](const Node& section) { drone.barometer = read_barometer(section); });
  object.visit_if("magnetometer", [&](const Node& section) { drone.magnetometer = read_magnetometer(section); });
  object.finish();
  return drone;
}

}  // namespace

Drone load_drone(const std::filesystem::path& file) {
  return data::Document(file).read(&read_drone);
}

}  // namespace mebots::world::scene
