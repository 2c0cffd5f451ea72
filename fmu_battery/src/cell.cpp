// SPDX-License-Identifier: Apache-2.0
#include "cell.hpp"

#include "mebots/data/document.hpp"
#include "mebots/data/estimate.hpp"
#include "mebots/data/object.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::battery {
namespace {

/// Default hysteresis: without a release voltage in the file, the release voltage is the cut-off voltage plus this
/// value. In protection circuits, the hysteresis is 0 to 0.7 V.
constexpr double kUsualHysteresis_v = 0.2;
/// Minimum hysteresis. With less, event location could open and close the protection without end.
constexpr double kLeastHysteresis_v = 1e-3;

/// Number of samples with which the sign and the slope of a curve are checked.
constexpr int kSamples = 1000;

/// Reads a curve. Reports a mistake if a value at a state of charge from `from_s` to 1 is not > 0.
Curve read_positive(const data::Node& node, std::string_view unit, double from_s) {
  const auto mistakes_before = node.noted();
  Curve curve = Curve::read(node, unit);
  if (node.noted() != mistakes_before) return curve;
  for (int i = 0; i <= kSamples; ++i) {
    const double s = from_s + (1 - from_s) * i / kSamples;
    if (data::Limits::positive().admit(curve(s))) continue;
    node.fail(
        ErrorCode::value_out_of_range,
        fmt::format("the curve is {} at state of charge {}; it must be > 0 between {} and 1", curve(s), s, from_s));
  }
  return curve;
}

Curve read_open_circuit(const data::Node& node) {
  Curve curve = read_positive(node, "V", 0);
  for (int i = 1; i <= kSamples; ++i) {
    const double s = static_cast<double>(i) / kSamples;
    if (!(curve(s) < curve(static_cast<double>(i - 1) / kSamples))) continue;
    node.fail(ErrorCode::invalid_value,
              fmt::format("the curve falls at state of charge {}; it must never fall with rising charge", s));
  }
  return curve;
}

void check_release_voltage(const data::Node& node, Cell& cell) {
  const double full_v = cell.open_circuit_v(1);
  if (!node.has("release_voltage")) cell.release_voltage_v = std::min(cell.release_voltage_v, full_v);
  if (cell.release_voltage_v >= cell.cut_off_voltage_v + kLeastHysteresis_v && cell.release_voltage_v <= full_v) return;
  node.at(node.has("release_voltage") ? "release_voltage" : "cut_off_voltage")
      .fail(
          ErrorCode::invalid_value,
          fmt::format("the release voltage of {} V must be at least {} V above the cut-off of {} V, and not above the "
                      "full cell's open-circuit voltage, {} V",
                      cell.release_voltage_v, kLeastHysteresis_v, cell.cut_off_voltage_v, full_v));
}

Cell read_cell(const data::Node& node, const CellPositions& positions) {
  using data::Limits;
  using data::quantity;
  data::Object object(node);
  Cell cell;
  object.comment("$schema");
  object.read("name", cell.name, &data::Node::text);
  object.comment("notes");
  object.read("mass", cell.mass_kg, quantity("kg", Limits::positive()));
  data::Estimate capacity;
  data::Estimate capacity_factor{1, {}};
  data::Estimate cut_off_voltage;
  data::Estimate cut_off_delay;
  object.read("capacity", capacity, data::estimate("C", Limits::positive()));
  object.read_if("capacity_factor", capacity_factor, data::estimate("1", Limits::positive()));
  object.read("cut_off_voltage", cut_off_voltage, data::estimate("V", Limits::at_least(0)));
  object.read_if("cut_off_delay", cut_off_delay, data::estimate("s", Limits::at_least(0)));
  const data::Placement placement("cell '" + cell.name + "'", cell.warnings);
  if (capacity.interval && !capacity_factor.interval) {
    capacity.value = placement.value(capacity, positions.capacity, "capacity", "calibration.capacity");
  } else {
    capacity_factor.value =
        placement.value(capacity_factor, positions.capacity, "capacity_factor", "calibration.capacity");
  }
  cell.capacity_c = capacity.value * capacity_factor.value;
  cell.cut_off_voltage_v =
      placement.value(cut_off_voltage, positions.cut_off_voltage, "cut_off_voltage", "calibration.cut_off_voltage");
  cell.cut_off_delay_s =
      placement.value(cut_off_delay, positions.cut_off_delay, "cut_off_delay", "calibration.cut_off_delay");
  cell.release_voltage_v = cell.cut_off_voltage_v + kUsualHysteresis_v;
  object.read_if("release_voltage", cell.release_voltage_v, quantity("V", Limits::positive()));
  object.read("continuous_current", cell.continuous_current_a, quantity("A", Limits::positive()));
  object.read("self_discharge_current", cell.self_discharge_current_a, quantity("A", Limits::at_least(0)));
  object.read("hold_below_state_of_charge", cell.hold_below_soc, quantity("1", Limits::between(0, 1)));
  data::Estimate resistance_factor{1, {}};
  double farads = 1;
  object.read("resistance_factor", resistance_factor, data::estimate("1", Limits::positive()));
  object.read("capacitance_factor", farads, quantity("1", Limits::positive()));
  const double ohms =
      placement.value(resistance_factor, positions.resistance, "resistance_factor", "calibration.resistance");
  farads *= resistance_factor.value / ohms;
  object.read("open_circuit_voltage", cell.open_circuit_v, &read_open_circuit);
  const auto element = [&](std::string_view key, std::string_view unit, double factor, Curve& curve) {
    object.read(key, curve, [&](const data::Node& member) {
      return read_positive(member, unit, cell.hold_below_soc).scaled(factor);
    });
  };
  element("series_resistance", "Ohm", ohms, cell.series_ohm);
  element("pair1_resistance", "Ohm", ohms, cell.pair1_ohm);
  element("pair1_capacitance", "F", farads, cell.pair1_farad);
  element("pair2_resistance", "Ohm", ohms, cell.pair2_ohm);
  element("pair2_capacitance", "F", farads, cell.pair2_farad);
  object.finish();

  if (object.sound() && cell.cut_off_voltage_v >= cell.open_circuit_v(1)) {
    node.at("cut_off_voltage")
        .fail(ErrorCode::invalid_value,
              fmt::format("the cut-off of {} V must be below the full cell's open-circuit voltage, {} V",
                          cell.cut_off_voltage_v, cell.open_circuit_v(1)));
  }
  if (object.sound()) check_release_voltage(node, cell);
  return cell;
}

}  // namespace

Circuit Cell::circuit_at(double s) const {
  const double held = std::max(s, hold_below_soc);
  return {open_circuit_v(s), series_ohm(held), pair1_ohm(held), pair1_farad(held), pair2_ohm(held), pair2_farad(held)};
}

Cell load_cell(const std::filesystem::path& path, const CellPositions& positions) {
  return data::Document(path).read([&](const data::Node& node) { return read_cell(node, positions); });
}

double terminal_current_a(double source_v, double series_ohm, double power_w) {
  const double discriminant = source_v * source_v - 4 * series_ohm * power_w;
  if (discriminant <= 0) return source_v / (2 * series_ohm);
  // This form of (E - sqrt(E^2 - 4 R P)) / (2 R) has no difference of nearly equal numbers.
  return 2 * power_w / (source_v + std::sqrt(discriminant));
}

double power_limit_w(double source_v, double series_ohm, double cut_off_v) {
  // Terminal voltages below half the source voltage are unstable. At half, the power has its maximum E^2 / (4 R).
  const double lowest_v = std::max(cut_off_v, source_v / 2);
  return lowest_v * (source_v - lowest_v) / series_ohm;
}

}  // namespace mebots::battery
