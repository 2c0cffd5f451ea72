// SPDX-License-Identifier: Apache-2.0
#include "robots.hpp"

#include "math/checks.hpp"
#include "math/rotation.hpp"
#include "mebots/assert.hpp"

#include <fmt/format.h>

namespace mebots::world {
namespace {

std::size_t checked_count(const scene::Scene& scene, const Parameters& parameters) {
  const auto count = static_cast<std::size_t>(parameters.robot_count);
  if (count > 0 && !scene.robot) {
    throw Error(
        fmt::format("robot.count = {}, but scene \"{}\" describes no robot; add the key \"robot\" to the scene, or "
                    "use a scene with a robot, such as yard",
                    count, scene.name));
  }
  return count;
}

}  // namespace

Robots::Robots(const scene::Scene& scene, const Parameters& parameters, const Inputs& inputs, std::int64_t start_ns)
    : in_(inputs), count_(checked_count(scene, parameters)) {
  if (count_ > 0) parts_ = scene::solids_of(*scene.robot);
  begin_step(start_ns);
}

void Robots::begin_step(std::int64_t start_ns) {
  for (std::size_t i = 0; i < count_; ++i) {
    const std::string_view name = robot::kWords[i];
    require_finite(in_.robot_position_x_m[i], name, ".position.x");
    require_finite(in_.robot_position_y_m[i], name, ".position.y");
    require_finite(in_.robot_position_z_m[i], name, ".position.z");
    require_finite(in_.robot_velocity_x_m_per_s[i], name, ".velocity.x");
    require_finite(in_.robot_velocity_y_m_per_s[i], name, ".velocity.y");
    require_finite(in_.robot_velocity_z_m_per_s[i], name, ".velocity.z");
    require_finite(in_.robot_yaw_rad[i], name, ".yaw");
    require_finite(in_.robot_yaw_rate_rad_per_s[i], name, ".yaw_rate");
  }
  start_ns_ = start_ns;
}

double Robots::yaw_rad(std::size_t robot, std::int64_t time_ns) const {
  return wrapped_rad(in_.robot_yaw_rad[robot] + since_start_s(time_ns) * in_.robot_yaw_rate_rad_per_s[robot]);
}

RigidState Robots::at(std::size_t robot, std::int64_t time_ns) const {
  MEBOTS_ASSERT(robot < count_);
  RigidState state;
  state.v_WB_m_per_s = {in_.robot_velocity_x_m_per_s[robot], in_.robot_velocity_y_m_per_s[robot],
                        in_.robot_velocity_z_m_per_s[robot]};
  state.p_WB_m = {in_.robot_position_x_m[robot], in_.robot_position_y_m[robot], in_.robot_position_z_m[robot]};
  state.p_WB_m += since_start_s(time_ns) * state.v_WB_m_per_s;
  state.q_WB = yaw_rotation(yaw_rad(robot, time_ns));
  state.w_WB_W_rad_per_s.z() = in_.robot_yaw_rate_rad_per_s[robot];
  return state;
}

void Robots::add_solids(std::vector<scene::Solid>& solids) const {
  for (std::size_t i = 0; i < count_; ++i) solids.insert(solids.end(), parts_.begin(), parts_.end());
}

void Robots::place(std::int64_t time_ns, std::vector<scene::Solid>& solids, std::size_t first,
                   std::vector<RigidState>& states) const {
  for (std::size_t i = 0; i < count_; ++i) {
    const RigidState state = at(i, time_ns);
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      scene::Solid& solid = solids[first + i * parts_.size() + part];
      solid.p_W_m = state.p_WB_m + state.q_WB * parts_[part].p_W_m;
      solid.q_W = state.q_WB * parts_[part].q_W;
    }
    states[states.size() - count_ + i] = state;
  }
}

void Robots::write_outputs(std::int64_t time_ns, Outputs& outputs) const {
  for (std::size_t i = 0; i < count_; ++i) {
    const RigidState state = at(i, time_ns);
    outputs.robot_place_x_m[i] = state.p_WB_m.x();
    outputs.robot_place_y_m[i] = state.p_WB_m.y();
    outputs.robot_place_z_m[i] = state.p_WB_m.z();
    outputs.robot_heading_rad[i] = yaw_rad(i, time_ns);
  }
}

}  // namespace mebots::world
