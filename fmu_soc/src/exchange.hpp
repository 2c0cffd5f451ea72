// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base64.hpp"
#include "mebots/soc/fixed_point.hpp"
#include "soc.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

/// What goes between the FMU's variables and those devices that have code of their own. The variables of a device are
/// there when the board that the FMU is built with has the device: all of this compiles for every board, and does
/// nothing for a device that is not on it.
namespace mebots::soc::exchange {

inline void require_number(double value, std::string_view name) {
  if (!std::isfinite(value)) throw Error(fmt::format("{} = {} must be a finite number", name, value));
}

template <typename Parameters>
Settings settings_of(const Parameters& parameters) {
  Settings settings;
  settings.clock_hz = parameters.core_clock_hz;
  settings.cluster_clock_hz = parameters.cluster_clock_hz;
  settings.cluster_cores = static_cast<unsigned>(parameters.cluster_cores);
  settings.temperature_c = parameters.temperature_degc;
  settings.voltage_v = parameters.core_supply_voltage_v;
  if constexpr (requires { parameters.camera_frame_width; }) {
    settings.frame_width = static_cast<std::uint32_t>(parameters.camera_frame_width);
  }
  if constexpr (requires { parameters.mission_policy; }) {
    settings.mission = {
        parameters.mission_cruise_speed_m_per_s,  parameters.mission_altitude_m,
        parameters.mission_frame_period_s,        parameters.mission_yaw_rate_scale_rad_per_s,
        parameters.mission_landing_charge,        static_cast<std::int32_t>(parameters.mission_policy),
        parameters.mission_initial_speed_m_per_s, static_cast<std::int32_t>(parameters.mission_navigator),
        parameters.mission_sleep_clock_hz};
  }
  return settings;
}

/// The voltage that the chip lives on, for its gauge too; the answer is false when it is under `least_v`.
template <typename Inputs>
bool take_battery(const Inputs& inputs, Soc& soc, double least_v) {
  if constexpr (requires { inputs.battery_voltage_v; }) {
    require_number(inputs.battery_voltage_v, "battery.voltage");
    require_number(inputs.battery_state_of_charge, "battery.state_of_charge");
    if (auto* battery = soc.battery()) {
      battery->set_voltage_v(inputs.battery_voltage_v);
      battery->set_state_of_charge(inputs.battery_state_of_charge);
    }
    return inputs.battery_voltage_v >= least_v;
  }
  return true;
}

template <typename Inputs>
double battery_voltage_v(const Inputs& inputs) {
  if constexpr (requires { inputs.battery_voltage_v; }) return inputs.battery_voltage_v;
  return 0;
}

template <typename Inputs>
void take_flight(const Inputs& inputs, Soc& soc) {
  if constexpr (requires { inputs.flight_range_m; }) {
    require_number(inputs.flight_range_m, "flight.range");
    require_number(inputs.flight_forward_velocity_m_per_s, "flight.forward_velocity");
    require_number(inputs.flight_yaw_rad, "flight.yaw");
    if (auto* flight = soc.flight()) {
      flight->inputs = {static_cast<std::int32_t>(inputs.flight_phase), inputs.flight_range_m,
                        inputs.flight_forward_velocity_m_per_s, inputs.flight_yaw_rad, inputs.flight_gate_passed};
    }
  }
}

/// `decoded` keeps the bytes of a picture that came as text.
template <typename Inputs>
void offer_picture(const Inputs& inputs, Soc& soc, std::vector<std::uint8_t>& decoded) {
  if constexpr (requires { inputs.camera_frame_id; }) {
    auto* camera = soc.camera();
    if (camera == nullptr || soc.end() == End::powered_off || !camera->wants(inputs.camera_frame_id)) return;
    auto picture = inputs.camera_frame.bytes();
    if (picture.empty()) {
      if (!decode_base64(inputs.camera_frame_base64, decoded)) {
        throw Error(fmt::format("camera.frame.base64 of {} characters is not base64 (RFC 4648)",
                                inputs.camera_frame_base64.size()));
      }
      picture = decoded;
    }
    if (!picture.empty()) camera->offer(picture, soc.now());
  }
}

template <typename Outputs>
void write_camera(const Soc& soc, Outputs& outputs) {
  if constexpr (requires { outputs.camera_trigger; }) {
    if (const auto* camera = soc.camera()) {
      outputs.camera_trigger = camera->requests();
      outputs.camera_energy_j = soc.camera_energy_j();
    }
  }
}

/// The mean over a step that began with `before_j`.
template <typename Outputs>
void write_camera_power(const Soc& soc, double before_j, double duration_s, Outputs& outputs) {
  if constexpr (requires { outputs.camera_power_w; }) {
    outputs.camera_power_w = (soc.camera_energy_j() - before_j) / duration_s;
  }
}

template <typename Outputs>
void write_flight(const Soc& soc, Outputs& outputs) {
  if constexpr (requires { outputs.setpoint_mode; }) {
    if (const auto* flight = soc.flight()) {
      const auto& sent = flight->sent();
      outputs.setpoint_mode = static_cast<decltype(outputs.setpoint_mode)>(sent.mode);
      outputs.setpoint_velocity_x_m_per_s = from_register(sent.velocity_x, kMicro);
      outputs.setpoint_velocity_y_m_per_s = from_register(sent.velocity_y, kMicro);
      outputs.setpoint_yaw_rate_rad_per_s = from_register(sent.yaw_rate, kMicro);
      outputs.setpoint_altitude_m = from_register(sent.altitude, kMicro);
    }
  }
}

}  // namespace mebots::soc::exchange
