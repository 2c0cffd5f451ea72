// SPDX-License-Identifier: Apache-2.0
#include "drone.hpp"

#include "math/arrays.hpp"
#include "math/checks.hpp"
#include "math/rotation.hpp"
#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <utility>

namespace mebots::world {
namespace {

/// A surface supports the drone if the normal of the touch is at most 45 degrees from the vertical.
constexpr double kSupportNormal_z = 0.7071;
/// A drone whose underside is at or below this height at the start is on the ground.
constexpr double kOnGround_m = 0.01;
constexpr double kStartOverlap_m = 0.001;

const std::string kGround = "the ground";

Calibration calibrate(scene::Drone& drone, const DroneParameters& parameters) {
  Calibration calibration;
  const data::Placement placement("drone '" + drone.name + "'", calibration.warnings);
  drone.drag_n_s_per_m *=
      placement.value(drone.drag_factor, parameters.calibration_drag, "drag_factor", "calibration.drag");
  calibration.dry_mass_factor =
      placement.value(drone.dry_mass_factor, parameters.calibration_mass, "dry_mass_factor", "calibration.mass");
  return calibration;
}

RigidState start_of(const scene::Scene& scene, const Parameters& shared, const DroneParameters& parameters,
                    std::size_t index) {
  RigidState state;
  for (std::size_t i = 0; i < 3; ++i) require_finite(parameters.start_offset_m[i], "start.offset.", axis::kWords[i]);
  for (std::size_t i = 0; i < 3; ++i) require_finite(shared.start_spacing_m[i], "start.spacing.", axis::kWords[i]);
  require_finite(parameters.start_yaw_offset_rad, "start.yaw_offset");
  state.p_WB_m = scene.start.p_WB_m + to_vector(parameters.start_offset_m);
  if (index > 0) state.p_WB_m += static_cast<double>(index) * to_vector(shared.start_spacing_m);
  state.q_WB = yaw_rotation(wrapped_rad(scene.start.yaw_rad + parameters.start_yaw_offset_rad));
  return state;
}

bool is_on_ground(const RigidState& state, const scene::Drone& model) {
  return state.p_WB_m.z() - 0.5 * model.body_size_m.z() <= kOnGround_m;
}

}  // namespace

Drone::Drone(const Around& around, std::size_t index, DroneSetup setup, std::int64_t start_ns)
    : around_(around),
      index_(index),
      name_(std::move(setup.name)),
      model_(std::move(setup.model)),
      calibration_(calibrate(model_, setup.parameters)),
      shared_(around.parameters),
      in_(setup.parameters),
      inputs_(setup.inputs),
      outputs_(setup.outputs),
      state_(start_of(around.scene, shared_, in_, index)),
      sensors_(around.views, model_, shared_, in_, index, start_ns),
      link_(std::llround(checked(in_.setpoint_latency_s, 0.0, 10.0, "setpoint.latency") * 1e9)),
      contact_(is_on_ground(state_, model_), state_.p_WB_m.z(), start_ns,
               std::llround(checked(in_.drone_grounded_after_s, 0.0, 60.0, "drone.grounded_after") * 1e9)),
      sequencer_(is_on_ground(state_, model_)),
      gates_({around.scene.gates.begin(), around.scene.gates.end()}, model_.body_size_m),
      flight_control_(model_, in_.stabiliser_controller, in_.stabiliser_propellers, in_.stabiliser_state, state_,
                      start_ns) {
  for (const auto& warning : calibration_.warnings) log(warning);
  require_at_least_zero(in_.drone_dry_mass_kg, "drone.dry_mass");
  checked(in_.rotors_inertia_kg_m2, 0.0, 1.0, "rotors.inertia");
  checked(in_.rotors_radius_m, 1e-3, 10.0, "rotors.radius");
  checked(in_.rotors_ground_effect, 0.0, 4.0, "rotors.ground_effect");
  check_words();
  check_inputs();
  rotor_speed_rad_per_s_ = inputs_.rotor_speed_rad_per_s;  // rotors that turn at the start do not accelerate
  take_mass();
  around_.bodies.place(index_, state_);
}

void Drone::start(std::int64_t start_ns, const Others& others) {
  for (const Touch& touch : around_.bodies.touches(index_)) {
    if (touch.depth_m <= kStartOverlap_m) continue;
    throw Error(
        fmt::format("scene \"{}\": the drone would start {:.4f} m deep in {}, at ({}, {}, {}) m; change {}start.offset",
                    around_.scene.name, touch.depth_m, name_of(touch), state_.p_WB_m.x(), state_.p_WB_m.y(),
                    state_.p_WB_m.z(), touch.what == Touch::What::drone ? "start.spacing or " : ""));
  }
  sensors_.start(state_, start_ns, others);
  write_outputs();
}

std::string Drone::name_of(const Touch& touch) const {
  MEBOTS_ASSERT(touch.what != Touch::What::gate || touch.index < around_.scene.gates.size());
  MEBOTS_ASSERT(touch.what != Touch::What::obstacle || touch.index < around_.obstacle_names.size());
  switch (touch.what) {
    case Touch::What::obstacle:
      return around_.obstacle_names[touch.index];
    case Touch::What::gate:
      return around_.scene.gates[touch.index].name;
    case Touch::What::drone:
      return fmt::format("drone[{}]", touch.index + 1);
    case Touch::What::robot:
      return fmt::format("robot[{}]", touch.index + 1);
    case Touch::What::ground:
      break;
  }
  return kGround;
}

void Drone::check_words() const {
  if (to_string(in_.stabiliser_controller) == "?") {
    throw Error(fmt::format("stabiliser.controller = {} is not a controller; ideal is 0, crazyflie 1",
                            static_cast<std::int32_t>(in_.stabiliser_controller)));
  }
  if (to_string(in_.stabiliser_propellers) == "?") {
    throw Error(fmt::format("stabiliser.propellers = {} are no known propellers; legacy is 0, plus 1, thrust_upgrade 2",
                            static_cast<std::int32_t>(in_.stabiliser_propellers)));
  }
  if (to_string(in_.stabiliser_state) == "?") {
    throw Error(fmt::format("stabiliser.state = {} is not a source of the state; truth is 0, estimate 1",
                            static_cast<std::int32_t>(in_.stabiliser_state)));
  }
  constexpr double kAttitudePeriod_s = 1e-9 * static_cast<double>(crazyflie::Controller::kAttitudePeriod_ns);
  if (in_.stabiliser_controller == FlightController::crazyflie && shared_.physics_step_s > kAttitudePeriod_s) {
    throw Error(
        fmt::format("physics.step = {} s is too long for stabiliser.controller = crazyflie, which runs every {} s",
                    shared_.physics_step_s, kAttitudePeriod_s));
  }
  if (in_.stabiliser_state == StateSource::estimate && std::llround(shared_.physics_step_s * 1e9) > Imu::kPeriod_ns) {
    constexpr double kImuPeriod_s = 1e-9 * static_cast<double>(Imu::kPeriod_ns);
    throw Error(
        fmt::format("physics.step = {} s is too long for stabiliser.state = estimate, which needs every sample of the "
                    "IMU, one each {} s; set physics.step to {} or less",
                    shared_.physics_step_s, kImuPeriod_s, kImuPeriod_s));
  }
}

void Drone::check_inputs() const {
  for (std::size_t i = 0; i < rotor::kCount; ++i) {
    require_at_least_zero(inputs_.rotor_thrust_n[i], rotor::kWords[i], ".thrust");
    require_at_least_zero(inputs_.rotor_torque_n_m[i], rotor::kWords[i], ".torque");
    require_at_least_zero(inputs_.rotor_speed_rad_per_s[i], rotor::kWords[i], ".speed");
  }
  require_finite(inputs_.setpoint_velocity_x_m_per_s, "setpoint.velocity.x");
  require_finite(inputs_.setpoint_velocity_y_m_per_s, "setpoint.velocity.y");
  require_finite(inputs_.setpoint_yaw_rate_rad_per_s, "setpoint.yaw_rate");
  require_at_least_zero(inputs_.setpoint_altitude_m, "setpoint.altitude");
  require_at_least_zero(inputs_.cell_mass_kg, "cell.mass");
  require_at_least_zero(inputs_.bus_voltage_v, "bus.voltage");
  if (to_string(inputs_.setpoint_mode) == "?") {
    throw Error(fmt::format("setpoint.mode = {} is not a mode; off is 0, take_off 1, fly 2, land 3",
                            static_cast<std::int32_t>(inputs_.setpoint_mode)));
  }
}

void Drone::take_mass() {
  const double mass_kg = calibration_.dry_mass_factor * in_.drone_dry_mass_kg + inputs_.cell_mass_kg;
  if (mass_kg != mass_kg_) set_mass(mass_kg);
}

void Drone::set_mass(double mass_kg) {
  const Eigen::Vector3d inertia_kg_m2 = inertia_for(model_, mass_kg);
  around_.bodies.set_mass(index_, mass_kg, inertia_kg_m2);
  flight_control_.set_mass(mass_kg, inertia_kg_m2);
  mass_kg_ = mass_kg;
}

void Drone::begin_step(std::int64_t start_ns, std::int64_t duration_ns, const Others& others) {
  check_inputs();
  take_mass();
  take_setpoint(start_ns, duration_ns);
  take_rotor_speeds(static_cast<double>(duration_ns) * 1e-9);
  sensors_.begin_step(inputs_.camera_trigger, state_, start_ns, others);
}

void Drone::take_setpoint(std::int64_t time_ns, std::int64_t duration_ns) {
  const Setpoint before = setpoint_;
  setpoint_ =
      link_.exchange({inputs_.setpoint_mode, inputs_.setpoint_velocity_x_m_per_s, inputs_.setpoint_velocity_y_m_per_s,
                      inputs_.setpoint_yaw_rate_rad_per_s, inputs_.setpoint_altitude_m},
                     time_ns);
  if (setpoint_ == before) return;
  outputs_.setpoint_link_time_s = static_cast<double>(link_.travelled_ns()) * 1e-9;
  outputs_.setpoint_control_time_s =
      static_cast<double>(duration_ns) * 1e-9;  // commands are sent at the end of the step
}

/// Assumes that the previous step had the same length: its change of speed gives the acceleration. The input is the
/// speed at the start of the step.
void Drone::take_rotor_speeds(double duration_s) {
  for (std::size_t i = 0; i < kRotors; ++i) {
    rotor_acceleration_rad_per_s2_[i] = (inputs_.rotor_speed_rad_per_s[i] - rotor_speed_rad_per_s_[i]) / duration_s;
  }
  rotor_speed_rad_per_s_ = inputs_.rotor_speed_rad_per_s;
}

Wrench Drone::rotors_wrench() const {
  RotorValues thrust_n = inputs_.rotor_thrust_n;
  if (in_.rotors_ground_effect > 0.0) {
    const double height_m = sensors_.range().distance_m(state_) + 0.5 * model_.body_size_m.z();
    const double growth = 1.0 + in_.rotors_ground_effect * (ground_effect(height_m, in_.rotors_radius_m) - 1.0);
    for (double& thrust : thrust_n) thrust *= growth;
  }
  Wrench wrench = rotor_wrench(model_, thrust_n, inputs_.rotor_torque_n_m);
  if (in_.rotors_inertia_kg_m2 > 0.0) {
    wrench.torque_n_m += spin_torque(in_.rotors_inertia_kg_m2, rotor_speed_rad_per_s_, rotor_acceleration_rad_per_s2_,
                                     state_.body_rate_rad_per_s());
  }
  return wrench;
}

void Drone::push(const Eigen::Vector3d& wind_W_m_per_s, const DownwashForce& downwash) {
  Wrench rotors_B = rotors_wrench();
  if (downwash.down_B_n > 0.0) rotors_B.force_n.z() -= downwash.down_B_n;
  air_force_W_n_ = state_.q_WB * rotors_B.force_n + drag_force(model_, state_, wind_W_m_per_s);
  if (downwash.up_W_n != 0.0) air_force_W_n_.z() += downwash.up_W_n;
  around_.bodies.place(index_, state_, air_force_W_n_, rotors_B.torque_n_m);
}

void Drone::move() {
  from_ = state_;
  state_ = around_.bodies.state(index_);
  path_length_m_ += (state_.p_WB_m - from_.p_WB_m).norm();
}

void Drone::judge(std::int64_t end_ns, double dt_s) {
  Situation situation;
  situation.altitude_m = state_.p_WB_m.z();
  situation.climb_m_per_s = state_.v_WB_m_per_s.z();
  situation.speed_m_per_s = state_.v_WB_m_per_s.norm();
  const FlightPhase before = sequencer_.phase();
  judge_touches(around_.bodies.touches(index_), end_ns, situation);
  if (before != FlightPhase::crashed) {
    if (const auto event = gates_.move(from_, state_)) report_gate(end_ns, *event);
  }
  if (before != FlightPhase::crashed && state_.rotation()(2, 2) < std::cos(around_.scene.contact.crash_tilt_rad)) {
    situation.crashed = true;
    report(end_ns, "crash: tipped over");
  }
  situation.has_landed = contact_.has_landed();
  sequencer_.update(setpoint_.mode, setpoint_.altitude_m, situation, dt_s);
  if (sequencer_.stands()) contact_.stand();
  report_phase(before, end_ns);
  if (before != FlightPhase::landed && sequencer_.phase() == FlightPhase::landed) {
    if (const auto event = gates_.land(state_, end_ns)) report_gate(end_ns, *event);
  }
}

void Drone::control(std::int64_t end_ns, double dt_s, const Others& others) {
  const bool touches = !around_.bodies.touches(index_).empty();
  const Eigen::Vector3d contact_W_n = touches ? contact_force_W(dt_s) : Eigen::Vector3d::Zero();
  sensors_.update({from_, state_, dt_s, end_ns, touches, contact_W_n}, others);
  flight_control_.update(goal(), state_, {sensors_.imu(), sensors_.flow(), sensors_.range()}, end_ns, dt_s,
                         inputs_.bus_voltage_v);
}

/// Returns the contact force: the change of momentum that neither gravity nor air causes. This is exact, because the
/// rigid bodies are integrated with v' = v + a dt.
Eigen::Vector3d Drone::contact_force_W(double dt_s) const {
  const Eigen::Vector3d acceleration_W = (state_.v_WB_m_per_s - from_.v_WB_m_per_s) / dt_s;
  return mass_kg_ * (acceleration_W + kGravity_m_per_s2 * Eigen::Vector3d::UnitZ()) - air_force_W_n_;
}

void Drone::judge_touches(const std::vector<Touch>& touches, std::int64_t time_ns, Situation& situation) {
  bool on_surface = false;  // a drone that hangs on a gate is handled by the gate judge
  for (const Touch& touch : touches) {
    const bool supports = touch.normal_W.z() > kSupportNormal_z;
    situation.supported = situation.supported || supports;
    on_surface = on_surface || (supports && touch.what != Touch::What::gate);
    if (touch.what == Touch::What::gate && sequencer_.phase() != FlightPhase::crashed) {
      if (const auto event = gates_.touch(touch.index, time_ns)) {
        report_gate(time_ns, *event, touch.closing_speed_m_per_s);
      }
    }
    if (touch.closing_speed_m_per_s <= around_.scene.contact.crash_speed_m_per_s) continue;
    if (!situation.crashed && sequencer_.phase() != FlightPhase::crashed) {
      report(time_ns, fmt::format("crash: hit {} with {:.3f} m/s", name_of(touch), touch.closing_speed_m_per_s));
    }
    situation.crashed = true;
  }
  contact_.update(on_surface, situation.altitude_m, time_ns);
}

void Drone::report_gate(std::int64_t time_ns, const GateEvent& event, double closing_speed_m_per_s) const {
  const std::string& name = around_.scene.gates[event.gate].name;
  const auto crossing = [&](std::string_view how) {
    report(time_ns, fmt::format("{} {}: {:.3f} m left of its middle, {:.3f} m above", how, name, event.lateral_m,
                                event.vertical_m));
  };
  switch (event.kind) {
    case GateEvent::Kind::crossed:
      return crossing("crossed");
    case GateEvent::Kind::missed:
      return crossing("missed");
    case GateEvent::Kind::turned_back:
      return report(time_ns, fmt::format("turned back: in front of {} again", name));
    case GateEvent::Kind::touched:
      return report(time_ns, fmt::format("touched {} with {:.3f} m/s", name, closing_speed_m_per_s));
    case GateEvent::Kind::stuck:
      return report(time_ns, fmt::format("stuck in {}", name));
  }
}

void Drone::report_phase(FlightPhase before, std::int64_t time_ns) {
  const FlightPhase now = sequencer_.phase();
  if (now == before) return;
  switch (now) {
    case FlightPhase::climbing:
      return report(time_ns, "take-off");
    case FlightPhase::flying:
      return report(time_ns, "flying");
    case FlightPhase::descending:
      return report(time_ns, "landing");
    case FlightPhase::landed:
      return report(time_ns, "landed");
    case FlightPhase::grounded:
      return note_descent(time_ns);
    case FlightPhase::on_ground:
    case FlightPhase::crashed:
      return;  // the crash has been reported with its cause
  }
}

void Drone::note_descent(std::int64_t time_ns) {
  const double since_s = static_cast<double>(contact_.since_ns()) * 1e-9;
  report(time_ns, fmt::format("on the ground since t = {:.4f} s without a landing, motors on, with a mass of {:.4g} kg",
                              since_s, mass_kg_));
  if (came_down_) return;
  came_down_ = true;
  came_down_time_s_ = since_s;
}

StabiliserGoal Drone::goal() const {
  StabiliserGoal goal;
  goal.motors_on = sequencer_.motors_on();
  goal.hold_place = setpoint_.mode != FlightMode::fly;
  goal.forward_m_per_s = setpoint_.forward_m_per_s;
  goal.left_m_per_s = setpoint_.left_m_per_s;
  goal.yaw_rate_rad_per_s = setpoint_.yaw_rate_rad_per_s;
  goal.descend = setpoint_.mode == FlightMode::land;
  goal.altitude_m = setpoint_.altitude_m;
  return goal;
}

void Drone::write_outputs() {
  const Eigen::Matrix3d R_WB = state_.rotation();
  const Attitude attitude = attitude_of(R_WB);
  outputs_.rotor_command = flight_control_.command();
  outputs_.drone_position_m = to_array(state_.p_WB_m);
  outputs_.drone_velocity_m_per_s = to_array(state_.v_WB_m_per_s);
  outputs_.drone_roll_rad = attitude.roll_rad;
  outputs_.drone_pitch_rad = attitude.pitch_rad;
  outputs_.drone_yaw_rad = attitude.yaw_rad;
  outputs_.drone_angular_velocity_rad_per_s = to_array(state_.body_rate_rad_per_s());
  outputs_.drone_forward_velocity_m_per_s =
      std::cos(attitude.yaw_rad) * state_.v_WB_m_per_s.x() + std::sin(attitude.yaw_rad) * state_.v_WB_m_per_s.y();
  outputs_.drone_speed_m_per_s = state_.v_WB_m_per_s.head<2>().norm();
  outputs_.drone_mass_kg = mass_kg_;
  outputs_.drone_path_length_m = path_length_m_;
  outputs_.drone_phase = sequencer_.phase();
  outputs_.drone_landed = sequencer_.phase() == FlightPhase::landed;
  outputs_.drone_crashed = sequencer_.phase() == FlightPhase::crashed;
  outputs_.drone_grounded = came_down_;
  outputs_.drone_grounded_time_s = came_down_time_s_;
  sensors_.write(outputs_);
  write_estimate();
  outputs_.gate_reached = gates_.reached();
  outputs_.gate_crossed = gates_.crossed();
  outputs_.gate_passed = gates_.passed();
  outputs_.gate_touched = gates_.touched();
  outputs_.gate_missed = gates_.missed();
  outputs_.gate_turned_back = gates_.turned_back();
  outputs_.gate_stuck = gates_.stuck();
  outputs_.gate_distance_m = gates_.distance_m(state_.p_WB_m);
  outputs_.gate_lateral_error_m = gates_.lateral_error_m();
}

void Drone::write_estimate() {
  const RigidState* estimate = flight_control_.estimate();
  if (estimate == nullptr) return;
  const Attitude attitude = attitude_of(estimate->rotation());
  outputs_.estimate_position_m = to_array(estimate->p_WB_m);
  outputs_.estimate_velocity_m_per_s = to_array(estimate->v_WB_m_per_s);
  outputs_.estimate_roll_rad = attitude.roll_rad;
  outputs_.estimate_pitch_rad = attitude.pitch_rad;
  outputs_.estimate_yaw_rad = attitude.yaw_rad;
  outputs_.estimate_forward_velocity_m_per_s =
      std::cos(attitude.yaw_rad) * estimate->v_WB_m_per_s.x() + std::sin(attitude.yaw_rad) * estimate->v_WB_m_per_s.y();
}

void Drone::report(std::int64_t time_ns, std::string_view what) const {
  log(fmt::format("t = {:.4f} s, at ({:.3f}, {:.3f}, {:.3f}) m: {}", static_cast<double>(time_ns) * 1e-9,
                  state_.p_WB_m.x(), state_.p_WB_m.y(), state_.p_WB_m.z(), what));
}

void Drone::log(std::string_view text) const {
  if (!around_.log) return;
  around_.log(name_.empty() ? text : fmt::format("{}: {}", name_, text));
}

ViewedDrone Drone::view() const {
  const auto& settings = sensors_.camera().settings();
  return {model_, settings.intrinsics, settings.mounting, name_};
}

scene::Solid Drone::box() const {
  scene::Solid box;
  box.shape = scene::Solid::Shape::box;
  box.p_W_m = state_.p_WB_m;
  box.q_W = state_.q_WB;
  box.size_m = model_.body_size_m;
  box.radius_m = 0.5 * model_.body_size_m.norm();
  return box;
}

void Drone::visit(state::Visitor& v) {
  double mass_kg = mass_kg_;
  v("body", state_);
  v("mass_kg", mass_kg);
  v("path_length_m", path_length_m_);
  v("flight_control", flight_control_);
  v("contact", contact_);
  v("sequencer", sequencer_);
  v("came_down", came_down_);
  v("came_down_time_s", came_down_time_s_);
  v("gates", gates_);
  v("link", link_);
  v("setpoint", setpoint_);
  v("rotor_speed_rad_per_s", rotor_speed_rad_per_s_);
  v("rotor_acceleration_rad_per_s2", rotor_acceleration_rad_per_s2_);
  sensors_.visit(v);
  if (!v.restores()) return;
  set_mass(mass_kg);
  outputs_.camera_frame = fmu::BinaryRef::to(sensors_.camera().frame());
  outputs_.camera_depth = fmu::BinaryRef::to(sensors_.camera().depth());
}

}  // namespace mebots::world
