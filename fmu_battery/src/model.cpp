// SPDX-License-Identifier: Apache-2.0
#include "model.hpp"

#include "mebots/assert.hpp"
#include "mebots/data/find_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::battery {
namespace {

/// Shortest remainder of a step that is integrated after an event [s]. At 100 W, its energy is 1e-10 J.
constexpr double kShortest = 1e-12;

constexpr double seconds(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-9;
}

void check_power(double power_w, std::string_view name) {
  if (std::isfinite(power_w) && power_w >= 0) return;
  throw Error(fmt::format("{}.power = {} W must be finite and >= 0{}", name, power_w,
                          power_w < 0 ? "; connect sources of power to source.power" : ""));
}

double checked_soc(double soc) {
  if (std::isfinite(soc) && soc >= 0 && soc <= 1) return soc;
  throw Error(fmt::format("cell.initial_state_of_charge = {} must be >= 0 and <= 1", soc));
}

}  // namespace

Model::Model(const Parameters& parameters, const std::filesystem::path& resources, Log log)
    : log_(std::move(log)),
      cell_(load_cell(data::find_file(resources / "cells", parameters.cell_name, "cell.name"),
                      {parameters.calibration_resistance, parameters.calibration_capacity,
                       parameters.calibration_cut_off_voltage, parameters.calibration_cut_off_delay})),
      source_converter_(load_converter(resources / "converters.json", parameters.source_converter, "source.converter")),
      integrator_(cell_) {
  for (std::size_t i = 0; i < load::kCount; ++i) {
    load_converter_[i] = load_converter(resources / "converters.json", parameters.load_converter[i],
                                        fmt::format("{}.converter", load::kWords[i]));
  }
  for (const auto& warning : cell_.warnings) log_(Message::warning, warning);
  state_.soc = checked_soc(parameters.cell_initial_state_of_charge);
  full_ = state_.soc >= 1;
}

void Model::start(const Inputs& inputs, std::int64_t start_ns, Outputs& outputs) {
  const Demand now = demand(inputs);
  const Circuit circuit = cell_.circuit_at(state_.soc);
  const double source_v = circuit.open_circuit_v - state_.pair1_v - state_.pair2_v;
  if (state_.soc <= 0) {
    handle(Event::empty, seconds(start_ns));
  } else if (source_v < cell_.cut_off_voltage_v) {
    // The voltage is below the cut-off even without a load. If only a load lowers the voltage below the cut-off, the
    // protection opens in the first step instead. Opening here could keep the initial values from converging, because
    // loads and bus voltage depend on each other.
    open(cut_off_text(), seconds(start_ns));
  } else if (now.terminal_w() > power_limit_w(source_v, circuit.series_ohm, source_v / 2)) {
    handle(Event::no_power, seconds(start_ns));
  }
  write(inputs, outputs);
  outputs.losses_power_w = 0;
}

void Model::step(const Inputs& inputs, std::int64_t start_ns, std::int64_t duration_ns, Outputs& outputs) {
  if (state_.soc < kResumeChargingBelow) full_ = false;
  MEBOTS_ASSERT(duration_ns > 0);
  const Ledger before = ledger_;
  const double duration_s = seconds(duration_ns);
  double passed_s = 0;
  while (duration_s - passed_s > kShortest) {
    const Demand now = demand(inputs);
    // While the voltage is low, a part of the step ends at the latest when the delay ends and the protection opens.
    const double until_s =
        low_ ? std::min(duration_s - passed_s, cell_.cut_off_delay_s - low_s_) : duration_s - passed_s;
    const auto [reached_s, event] = integrator_.advance(state_, ledger_, now, protection(), until_s);
    if (conducts(now)) {
      for (std::size_t i = 0; i < load::kCount; ++i) load_energy_j_[i] += inputs.load_power_w[i] * reached_s;
    }
    if (event == Event::none && !low_) break;
    passed_s += reached_s;
    MEBOTS_ASSERT(passed_s <= duration_s);
    const double now_s = seconds(start_ns) + passed_s;
    if (low_) low_s_ += reached_s;
    if (event != Event::none) {
      handle(event, now_s);
    } else if (cell_.cut_off_delay_s - low_s_ <= kShortest) {
      handle_low(now_s);
    }
  }
  const double lost_j = (ledger_.ohmic_j - before.ohmic_j) + (ledger_.converters_j - before.converters_j);
  write(inputs, outputs);
  outputs.losses_power_w = lost_j / duration_s;
  watch_current(outputs.cell_current_a, start_ns + duration_ns, duration_ns);
}

Demand Model::demand(const Inputs& inputs) const {
  Demand demand;
  for (std::size_t i = 0; i < load::kCount; ++i) {
    const double power_w = inputs.load_power_w[i];
    check_power(power_w, load::kWords[i]);
    demand.delivered_w += power_w;
    demand.drawn_w += load_converter_[i].input_power_w(power_w);
  }
  check_power(inputs.source_power_w, "source");
  demand.source_w = inputs.source_power_w;
  demand.source_bus_w = source_converter_.output_power_w(inputs.source_power_w);
  if (full_ && demand.source_bus_w > demand.drawn_w) {
    demand.source_bus_w = demand.drawn_w;
    demand.source_w = source_converter_.input_power_w(demand.drawn_w);
  }
  return demand;
}

void Model::handle(Event event, double time_s) {
  if (event == Event::full) {
    full_ = true;
    report(fmt::format("t = {:.9g} s: the cell is full and takes no more charge until it is below {}", time_s,
                       kResumeChargingBelow));
    return;
  }
  if (event == Event::release) {
    connected_ = true;
    report(fmt::format(
        "t = {:.9g} s: the charging source lifts the terminal voltage to {} V at a state of charge of {:.4f}; the "
        "protection closes",
        time_s, cell_.release_voltage_v, state_.soc));
    return;
  }
  if (!connected_) return;  // self-discharge emptied the cell while the protection is open
  if (event == Event::recovered) {
    low_ = false;
  } else if (event == Event::cut_off && cell_.cut_off_delay_s > 0) {
    low_ = true;
    low_s_ = 0;
  } else if (event == Event::empty) {
    open("the cell is empty", time_s);
  } else if (event == Event::no_power) {
    open(fmt::format("no current gives the power of the loads at a state of charge of {:.4f}", state_.soc), time_s);
  } else {
    open(cut_off_text(), time_s);
  }
}

std::string Model::cut_off_text() const {
  return fmt::format("the terminal voltage falls under the cut-off of {} V at a state of charge of {:.4f}",
                     cell_.cut_off_voltage_v, state_.soc);
}

void Model::handle_low(double time_s) {
  open(fmt::format(
           "the terminal voltage has been under the cut-off of {} V for {:.9g} s, at a state of charge of {:.4f}",
           cell_.cut_off_voltage_v, cell_.cut_off_delay_s, state_.soc),
       time_s);
}

void Model::open(std::string_view why, double time_s) {
  connected_ = false;
  low_ = false;
  report(fmt::format("t = {:.9g} s: {}; the protection opens", time_s, why));
}

Protection Model::protection() const {
  if (!connected_) return Protection::open;
  return low_ ? Protection::low : Protection::closed;
}

bool Model::over_current(double current_a) const {
  return std::abs(current_a) > cell_.continuous_current_a;
}

// Updates the record of the current, and warns once if the current overheats the cell. The mean of the squared current
// follows the thermal model of IEC 60255-149, without the margin of that standard. It is a first-order lag that starts
// at 0 (a cold cell), integrated by the implicit Euler method.
void Model::watch_current(double current_a, std::int64_t now_ns, std::int64_t duration_ns) {
  const double duration_s = seconds(duration_ns);
  mean_square_a2_ += (current_a * current_a - mean_square_a2_) * duration_s / (kHeatingTimeConstant_s + duration_s);
  highest_current_a_ = std::max(highest_current_a_, std::abs(current_a));
  if (over_current(current_a)) over_current_ns_ += duration_ns;
  const double limit_a = cell_.continuous_current_a;
  if (overload_warned_ || mean_square_a2_ <= limit_a * limit_a) return;
  overload_warned_ = true;
  log_(Message::warning,
       fmt::format("t = {:.9g} s: the load heats the cell more than its continuous limit of {} A: the root mean square "
                   "of the current over {} s is {:.3f} A. The model has no temperature, and continues. Use a cell with "
                   "a higher limit or less power",
                   seconds(now_ns), limit_a, kHeatingTimeConstant_s, std::sqrt(mean_square_a2_)));
}

void Model::terminate() {
  if (over_current_ns_ == 0) return;
  report(
      fmt::format("at communication points, the current was above the cell's continuous limit of {} A for {:.9g} s; "
                  "its largest value was {:.3f} A",
                  cell_.continuous_current_a, seconds(over_current_ns_), highest_current_a_));
}

void Model::write(const Inputs& inputs, Outputs& outputs) const {
  const Circuit circuit = cell_.circuit_at(state_.soc);
  const double source_v = circuit.open_circuit_v - state_.pair1_v - state_.pair2_v;
  const Demand now = demand(inputs);
  const bool flows = conducts(now);
  const double current_a = flows ? terminal_current_a(source_v, circuit.series_ohm, now.terminal_w()) : 0;
  const double voltage_v = source_v - circuit.series_ohm * current_a;
  if (!std::isfinite(voltage_v)) {
    throw Error(fmt::format("source.power = {} W makes bus.voltage {} V, which must be finite; reduce the power",
                            inputs.source_power_w, voltage_v));
  }
  outputs.bus_voltage_v = flows ? voltage_v : 0;
  outputs.cell_voltage_v = voltage_v;
  outputs.cell_open_circuit_voltage_v = circuit.open_circuit_v;
  outputs.cell_current_a = current_a;
  outputs.cell_state_of_charge = state_.soc;
  outputs.cell_capacity_c = cell_.capacity_c;
  outputs.cell_mass_kg = cell_.mass_kg;
  outputs.cell_connected = connected_;
  outputs.cell_over_current = over_current(current_a);
  outputs.load_energy_j = load_energy_j_;
  outputs.energy_open_circuit_j = ledger_.open_circuit_j;
  outputs.energy_delivered_j = ledger_.delivered_j;
  outputs.energy_source_j = ledger_.source_j;
  outputs.energy_ohmic_j = ledger_.ohmic_j;
  outputs.energy_polarisation_j = ledger_.polarisation_j;
  outputs.energy_converters_j = ledger_.converters_j;
  outputs.energy_self_discharge_j = ledger_.self_discharge_j;
  outputs.energy_imbalance_j = ledger_.imbalance_j();
}

void Model::visit(state::Visitor& v) {
  v("cell", state_);
  v("ledger", ledger_);
  v("load_energy_j", load_energy_j_);
  v("connected", connected_);
  v("low", low_);
  v("low_s", low_s_);
  v("full", full_);
  v("mean_square_a2", mean_square_a2_);
  v("overload_warned", overload_warned_);
  v("over_current_ns", over_current_ns_);
  v("highest_current_a", highest_current_a_);
}

}  // namespace mebots::battery
