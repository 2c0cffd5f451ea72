// SPDX-License-Identifier: Apache-2.0
#include "model.hpp"

#include "dynamics/downwash.hpp"
#include "math/checks.hpp"
#include "mebots/assert.hpp"
#include "mebots/error.hpp"
#include "view/scene_text.hpp"

#include <fmt/format.h>
#include <cmath>
#include <utility>

namespace mebots::world {
namespace {

std::int64_t inner_step_of(const Parameters& parameters) {
  constexpr double kLongest_s = 1.0;
  const double step_s = parameters.physics_step_s;
  if (!(step_s >= 1e-6 && step_s <= kLongest_s)) {
    throw Error(fmt::format("physics.step = {} s must be from 1e-6 to {} s", step_s, kLongest_s));
  }
  return std::llround(step_s * 1e9);
}

/// Divides a duration into `count` equal parts. Returns the length of the first `index` parts together, rounded down.
/// The intermediate product may exceed 64 bits.
std::int64_t part_of(std::int64_t duration_ns, std::int64_t index, std::int64_t count) {
  MEBOTS_ASSERT(duration_ns >= 0 && 0 <= index && index <= count && count > 0);
  __extension__ using Wide = __int128;
  return static_cast<std::int64_t>(Wide{duration_ns} * index / count);
}

std::vector<std::string> names_of(const std::vector<scene::Solid>& solids) {
  std::vector<std::string> names;
  for (const auto& solid : solids) names.push_back(solid.name);
  return names;
}

std::vector<Eigen::Vector3d> sizes_of(const std::vector<DroneSetup>& drones) {
  std::vector<Eigen::Vector3d> sizes;
  for (const auto& drone : drones) sizes.push_back(drone.model.body_size_m);
  return sizes;
}

bool has_others(std::size_t drones, std::size_t robots) {
  return drones + robots > 1;
}

/// Returns the scenery of all cameras. Drones and robots are included only if the world has more than one of them.
std::shared_ptr<const camera::Scenery> scenery_of(const scene::Scene& scene, const std::vector<DroneSetup>& drones,
                                                  std::size_t robots) {
  camera::Geometry geometry = camera::make_geometry(scene);
  if (has_others(drones.size(), robots)) {
    for (std::size_t i = 0; i < drones.size(); ++i) camera::add_drone(geometry, drones[i].model, i);
    for (std::size_t i = 0; i < robots; ++i) camera::add_robot(geometry, *scene.robot, drones.size() + i);
  }
  return std::make_shared<const camera::Scenery>(std::move(geometry));
}

}  // namespace

World::World(scene::Scene scene, const Parameters& parameters, const Inputs& inputs, Outputs& outputs,
             std::vector<DroneSetup> drones, EventLog log, std::int64_t start_ns,
             std::optional<scene::DownwashNetworks> downwash_networks)
    : scene_(std::move(scene)),
      in_(parameters),
      inputs_(inputs),
      outputs_(outputs),
      log_(std::move(log)),
      inner_step_ns_(inner_step_of(parameters)),
      obstacle_names_(names_of(scene::solids_of(scene_))),
      robots_(scene_, parameters, inputs, start_ns),
      bodies_(scene_, sizes_of(drones), robots_.count()),
      gusts_({parameters.gust_intensity_m_per_s, parameters.gust_length_m, parameters.gust_speed_m_per_s,
              static_cast<std::uint32_t>(parameters.gust_seed)}) {
  checked(in_.downwash_strength, 0.0, 10.0, "downwash.strength");
  check_wind();
  const Around around{scene_, obstacle_names_,
                      in_,    bodies_,
                      log_,   {scenery_of(scene_, drones, robots_.count()), std::make_shared<const RayCaster>(scene_)}};
  drones_.resize(drones.size());
  for (std::size_t i = 0; i < drones.size(); ++i) {
    const std::string name = drones[i].name;
    try {
      drones_[i] = std::make_unique<Drone>(around, i, std::move(drones[i]), start_ns);
    } catch (const Error& error) {
      if (name.empty()) throw;
      throw Error(error.code(), name + ": " + error.what());
    }
  }
  downwash_.resize(drones_.size());
  if (downwash_networks) networks_.emplace(std::move(*downwash_networks));
  if (networks_ && in_.downwash_strength == 0.0) {
    log_("downwash.networks has no effect, because downwash.strength is 0; set it to 1");
  }
  touched_.resize(robots_.count());
  if (has_others(drones_.size(), robots_.count())) {
    for (const auto& drone : drones_) boxes_.push_back(drone->box());
    robots_.add_solids(boxes_);
    states_.resize(drones_.size() + robots_.count());
  }
  take_states(start_ns);
  move_robots();
  bodies_.find_touches(start_ns);
  note_touches();
  for_each_drone([&](Drone& drone, std::size_t i) { drone.start(start_ns, others_of(i)); });
  write_robots(start_ns);
}

/// Calls `act` for each drone. If the world has several drones, adds the drone's name to errors.
template <typename Act>
void World::for_each_drone(Act&& act) {
  for (std::size_t i = 0; i < drones_.size(); ++i) {
    try {
      act(*drones_[i], i);
    } catch (const Error& error) {
      if (drones_[i]->name().empty()) throw;
      throw Error(error.code(), drones_[i]->name() + ": " + error.what());
    }
  }
}

void World::check_wind() const {
  for (std::size_t i = 0; i < axis::kCount; ++i)
    require_finite(inputs_.wind_velocity_m_per_s[i], "wind.velocity.", axis::kWords[i]);
}

void World::step(std::int64_t start_ns, std::int64_t duration_ns) {
  check_wind();
  robots_.begin_step(start_ns);
  touched_.assign(touched_.size(), false);
  take_states(start_ns);
  for_each_drone([&](Drone& drone, std::size_t i) { drone.begin_step(start_ns, duration_ns, others_of(i)); });
  const std::int64_t count = (duration_ns + inner_step_ns_ - 1) / inner_step_ns_;
  const double dt_s = static_cast<double>(duration_ns) * 1e-9 / static_cast<double>(count);
  for (std::int64_t i = 0; i < count; ++i) {
    inner_step(start_ns + part_of(duration_ns, i, count), start_ns + part_of(duration_ns, i + 1, count), dt_s);
  }
  outputs_.wind_gust_m_per_s = {gust_W_m_per_s_.x(), gust_W_m_per_s_.y(), gust_W_m_per_s_.z()};
  for_each_drone([](Drone& drone, std::size_t) { drone.write_outputs(); });
  write_robots(start_ns + duration_ns);
}

void World::write_robots(std::int64_t end_ns) {
  robots_.write_outputs(end_ns, outputs_);
  for (std::size_t i = 0; i < touched_.size(); ++i) outputs_.robot_touched[i] = touched_[i];
}

void World::inner_step(std::int64_t begin_ns, std::int64_t end_ns, double dt_s) {
  gust_W_m_per_s_ = gusts_.at(begin_ns);
  const Eigen::Vector3d wind_W_m_per_s = Eigen::Vector3d(inputs_.wind_velocity_m_per_s.data()) + gust_W_m_per_s_;
  if (in_.downwash_strength > 0.0) find_downwash();
  for_each_drone([&](Drone& drone, std::size_t i) { drone.push(wind_W_m_per_s, downwash_[i]); });
  move_robots();
  bodies_.step(dt_s, begin_ns);
  for_each_drone([](Drone& drone, std::size_t) { drone.move(); });
  note_touches();
  take_states(end_ns);
  for_each_drone([&](Drone& drone, std::size_t i) {
    drone.judge(end_ns, dt_s);
    drone.control(end_ns, dt_s, others_of(i));
  });
}

void World::find_downwash() {
  for (std::size_t i = 0; i < drones_.size(); ++i) {
    downwash_[i] = {};
    if (networks_) {
      downwash_[i].up_W_n = in_.downwash_strength * networks_force_W_n(i);
      continue;
    }
    const Eigen::Vector3d& below_W_m = drones_[i]->state().p_WB_m;
    for (const auto& above : drones_) {
      downwash_[i].down_B_n +=
          in_.downwash_strength * downwash(above->state().p_WB_m - below_W_m, above->rotor_radius_m());
    }
  }
}

double World::networks_force_W_n(std::size_t drone) {
  networks_->begin(drones_[drone]->state());
  for (std::size_t i = 0; i < drones_.size(); ++i) {
    if (i != drone) networks_->add(drones_[i]->state());
  }
  return networks_->force_W_n();
}

void World::move_robots() {
  for (std::size_t i = 0; i < robots_.count(); ++i) bodies_.move_robot(i, states_[drones_.size() + i]);
}

void World::note_touches() {
  for (std::size_t i = 0; i < touched_.size(); ++i) touched_[i] = touched_[i] || bodies_.robot_touches(i);
}

void World::take_states(std::int64_t time_ns) {
  if (states_.empty()) return;
  robots_.place(time_ns, boxes_, drones_.size(), states_);
  for (std::size_t i = 0; i < drones_.size(); ++i) {
    states_[i] = drones_[i]->state();
    boxes_[i].p_W_m = states_[i].p_WB_m;
    boxes_[i].q_W = states_[i].q_WB;
  }
}

const CameraDevice* World::camera(std::size_t drone) const {
  if (drone >= drones_.size()) return nullptr;  // fewer drones than the FMU has variables for
  return &drones_[drone]->camera();
}

std::string World::view() const {
  std::vector<ViewedDrone> drones;
  for (const auto& drone : drones_) drones.push_back(drone->view());
  return scene_text(scene_, drones, robots_.count());
}

void World::visit(state::Visitor& v) {
  v("gusts", gusts_);
  v("gust_W_m_per_s", numbers(gust_W_m_per_s_));
  for (std::size_t i = 0; i < drones_.size(); ++i) v(fmt::format("drone[{}]", i + 1), *drones_[i]);
}

}  // namespace mebots::world
