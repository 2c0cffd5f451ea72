// SPDX-License-Identifier: Apache-2.0
#include "model.hpp"

#include "base64.hpp"
#include "devices/fixed_point.hpp"

#include <fmt/core.h>

#include <cmath>

namespace mebots::soc {
namespace {

constexpr double kPicosecond = 1e-12;
constexpr double kNanosecond = 1e-9;

/// In the order of Part.
constexpr std::array<double Outputs::*, kParts> kPartPowers{
    &Outputs::power_fabric_controller_w,
    &Outputs::power_cluster_cores_w,
    &Outputs::power_fc_memory_w,
    &Outputs::power_l2_w,
    &Outputs::power_l1_w,
    &Outputs::power_interconnect_w,
    &Outputs::power_dma_w,
    &Outputs::power_fc_background_w,
    &Outputs::power_cluster_background_w,
    &Outputs::power_leakage_w,
    &Outputs::power_retention_w,
};
static_assert(std::tuple_size_v<decltype(Outputs::energy_j)> == kParts);

Settings settings_of(const Parameters& parameters) {
  Settings settings;
  settings.clock_hz = parameters.core_clock_hz;
  settings.cluster_clock_hz = parameters.cluster_clock_hz;
  settings.cluster_cores = static_cast<unsigned>(parameters.cluster_cores);
  settings.temperature_c = parameters.temperature_degc;
  settings.voltage_v = parameters.core_supply_voltage_v;
  settings.frame_width = static_cast<std::uint32_t>(parameters.camera_frame_width);
  settings.mission = {parameters.mission_cruise_speed_m_per_s,  parameters.mission_altitude_m,
                      parameters.mission_frame_period_s,        parameters.mission_yaw_rate_scale_rad_per_s,
                      parameters.mission_landing_charge,        static_cast<std::int32_t>(parameters.mission_policy),
                      parameters.mission_initial_speed_m_per_s, static_cast<std::int32_t>(parameters.mission_navigator),
                      parameters.mission_sleep_clock_hz};
  return settings;
}

Elf firmware_of(const Parameters& parameters, const std::filesystem::path& resources) {
  if (parameters.firmware.empty()) return Elf::read(resources / "gate.elf");
  try {
    return Elf::read(parameters.firmware);
  } catch (const Error& error) {
    throw Error(fmt::format("firmware = \"{}\": {}", parameters.firmware, error.what()));
  }
}

observe::Requests requests_of(const Parameters& parameters, const Listeners& listeners) {
  const auto path = [](const std::string& text) {
    return text.empty() ? std::nullopt : std::optional<std::string>(text);
  };
  observe::Requests requests;
  requests.names = {"observe.trace", "observe.profile", "observe.power_trace"};
  requests.trace = path(parameters.observe_trace);
  requests.profile = path(parameters.observe_profile);
  requests.power_trace = path(parameters.observe_power_trace);
  if (parameters.gdb_port >= 0) requests.gdb_port = parameters.gdb_port;
  requests.gdb_kill = debug::GdbServer::Kill::lets_go;
  requests.announce = [&listeners](std::string_view text) {
    if (listeners.observe) listeners.observe(text);
  };
  return requests;
}

void require_number(double value, std::string_view name) {
  if (!std::isfinite(value)) throw Error(fmt::format("{} = {} must be a finite number", name, value));
}

}  // namespace

Model::Model(const Parameters& parameters, const std::filesystem::path& resources, Listeners listeners)
    : listeners_(listeners),
      soc_(read_board(resources / "ai_deck.json"), gap8(), settings_of(parameters), firmware_of(parameters, resources),
           std::move(listeners)) {
  const auto requests = requests_of(parameters, listeners_);
  if (requests.any()) session_ = std::make_unique<observe::Session>(requests, soc_);
}

Model::~Model() {
  if (!session_) return;
  try {
    session_->finish(soc_.exit_code());
  } catch (const std::exception& error) {
    if (listeners_.observe) listeners_.observe(error.what());
  }
}

void Model::start(const Inputs& inputs, std::int64_t start_ns, Outputs& outputs) {
  origin_ns_ = start_ns;
  take_inputs(inputs);
  write(outputs);
}

void Model::step(const Inputs& inputs, std::int64_t start_ns, std::int64_t duration_ns, Outputs& outputs) {
  take_inputs(inputs);
  const auto energy_before = soc_.energy();
  const auto camera_before_j = soc_.camera_energy_j();
  soc_.advance(start_ns - origin_ns_ + duration_ns);
  say_when_spinning();
  write(outputs);
  const auto duration_s = static_cast<double>(duration_ns) * kNanosecond;
  const auto energy_after = soc_.energy();
  outputs.power_w = (energy_after.total_j() - energy_before.total_j()) / duration_s;
  for (std::size_t i = 0; i < kParts; ++i) {
    outputs.*kPartPowers[i] = (energy_after.by_part_j[i] - energy_before.by_part_j[i]) / duration_s;
  }
  outputs.camera_power_w = (outputs.camera_energy_j - camera_before_j) / duration_s;
}

/// An endless loop is nothing that ends a mission, but somebody should know.
void Model::say_when_spinning() {
  if (said_spinning_ || !soc_.spins()) return;
  said_spinning_ = true;
  if (!listeners_.faults) return;
  const auto pc = soc_.hart().pc();
  listeners_.faults(
      fmt::format("the core jumps to itself for ever at pc 0x{:08x} in {}: no interrupt is enabled that could end it",
                  pc, soc_.program().where(pc)));
}

void Model::take_inputs(const Inputs& inputs) {
  require_number(inputs.battery_voltage_v, "battery.voltage");
  require_number(inputs.battery_state_of_charge, "battery.state_of_charge");
  require_number(inputs.flight_range_m, "flight.range");
  require_number(inputs.flight_forward_velocity_m_per_s, "flight.forward_velocity");
  require_number(inputs.flight_yaw_rad, "flight.yaw");
  if (inputs.battery_voltage_v < kPowerLossVoltageV && soc_.end() != End::powered_off) {
    soc_.power_off();
    if (listeners_.faults) {
      listeners_.faults(fmt::format("battery.voltage {} V is under {} V: the chip lost its power at {:.9g} s",
                                    inputs.battery_voltage_v, kPowerLossVoltageV,
                                    static_cast<double>(soc_.now()) * kPicosecond));
    }
  }
  if (auto* battery = soc_.battery()) {
    battery->set_voltage_v(inputs.battery_voltage_v);
    battery->set_state_of_charge(inputs.battery_state_of_charge);
  }
  if (auto* flight = soc_.flight()) {
    flight->inputs = {static_cast<std::int32_t>(inputs.flight_phase), inputs.flight_range_m,
                      inputs.flight_forward_velocity_m_per_s, inputs.flight_yaw_rad, inputs.flight_gate_passed ? 1 : 0};
  }
  offer_picture(inputs);
}

void Model::offer_picture(const Inputs& inputs) {
  auto* camera = soc_.camera();
  if (camera == nullptr || soc_.end() == End::powered_off || !camera->wants(inputs.camera_frame_id)) return;
  auto picture = inputs.camera_frame.bytes();
  if (picture.empty()) {
    if (!decode_base64(inputs.camera_frame_base64, decoded_)) {
      throw Error(fmt::format("camera.frame.base64 of {} characters is not base64 (RFC 4648)",
                              inputs.camera_frame_base64.size()));
    }
    picture = decoded_;
  }
  if (!picture.empty()) camera->offer(picture, soc_.now());
}

void Model::write(Outputs& outputs) const {
  const auto& counters = soc_.hart().counters();
  const auto energy = soc_.energy();
  outputs.instructions = static_cast<double>(counters.instructions);
  outputs.cycles = static_cast<double>(counters.cycles);
  outputs.sleep_time_s = static_cast<double>(soc_.sleep_time()) * kPicosecond;
  outputs.core_running = soc_.running();
  outputs.core_faulted = soc_.hart().fault().happened;
  outputs.core_exit_code = soc_.exit_code();
  outputs.energy_total_j = energy.total_j();
  for (std::size_t i = 0; i < kParts; ++i) outputs.energy_j[i] = energy.by_part_j[i];
  outputs.energy_core_active_j = energy.core_active_j();
  outputs.energy_memory_j = energy.memory_j();
  if (const auto* cluster = soc_.cluster()) {
    const auto sums = cluster->counters();
    outputs.cluster_instructions = static_cast<double>(sums.instructions);
    outputs.cluster_cycles = static_cast<double>(sums.cycles);
    outputs.cluster_powered = cluster->powered();
  }
  if (const auto* camera = soc_.camera()) {
    outputs.camera_trigger = camera->requests();
    outputs.camera_energy_j = soc_.camera_energy_j();
  }
  if (const auto* flight = soc_.flight()) {
    const auto& sent = flight->sent();
    outputs.setpoint_mode = static_cast<FlightMode>(sent.mode);
    outputs.setpoint_velocity_x_m_per_s = from_register(sent.velocity_x, kMicro);
    outputs.setpoint_velocity_y_m_per_s = from_register(sent.velocity_y, kMicro);
    outputs.setpoint_yaw_rate_rad_per_s = from_register(sent.yaw_rate, kMicro);
    outputs.setpoint_altitude_m = from_register(sent.altitude, kMicro);
  }
}

void Model::save(state::Writer& writer) const {
  writer.put(origin_ns_);
  soc_.save(writer);
}

void Model::restore(state::Reader& reader) {
  reader.get(origin_ns_);
  soc_.restore(reader);
  if (session_) session_->restored();
}

}  // namespace mebots::soc
