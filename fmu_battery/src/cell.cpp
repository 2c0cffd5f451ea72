// SPDX-License-Identifier: Apache-2.0
#include "cell.hpp"

#include "mebots/data_file.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::battery {
namespace {

/// Fine enough to see a wrong sign or a falling stretch of any curve that is meant for a battery.
constexpr int kSamples = 1000;

void check_positive(const data::Node& file, const char* key, const Curve& curve, double from_s) {
  for (int i = 0; i <= kSamples; ++i) {
    const double s = from_s + (1 - from_s) * i / kSamples;
    if (!data::Limits::positive().admit(curve(s))) {
      file.fail(key, fmt::format("is {} at state of charge {}; it must be > 0 between {} and 1", curve(s), s, from_s));
    }
  }
}

void check_open_circuit(const data::Node& file, const Curve& curve) {
  double before = 0;
  for (int i = 0; i <= kSamples; ++i) {
    const double s = static_cast<double>(i) / kSamples;
    const double value = curve(s);
    if (!data::Limits::positive().admit(value) || value < before) {
      file.fail(
          "open_circuit_voltage",
          fmt::format("is {} V at state of charge {}; it must be > 0 and never fall with rising charge", value, s));
    }
    before = value;
  }
}

}  // namespace

Circuit Cell::circuit_at(double s) const {
  const double held = std::max(s, hold_below_soc);
  return {open_circuit_v(s), series_ohm(held), pair1_ohm(held), pair1_farad(held), pair2_ohm(held), pair2_farad(held)};
}

Cell load_cell(const std::filesystem::path& path) {
  const data::File file(path);
  const data::Node root = file.root();
  root.only({"name", "notes", "mass", "capacity", "cut_off_voltage", "continuous_current", "self_discharge_current",
             "hold_below_state_of_charge", "resistance_factor", "capacitance_factor", "open_circuit_voltage",
             "series_resistance", "pair1_resistance", "pair1_capacitance", "pair2_resistance", "pair2_capacitance"});
  using data::Limits;
  Cell cell;
  cell.name = root.text("name");
  cell.mass_kg = root.quantity("mass", "kg", Limits::positive());
  cell.capacity_c = root.quantity("capacity", "C", Limits::positive());
  cell.cut_off_voltage_v = root.quantity("cut_off_voltage", "V", Limits::at_least(0));
  cell.continuous_current_a = root.quantity("continuous_current", "A", Limits::positive());
  cell.self_discharge_current_a = root.quantity("self_discharge_current", "A", Limits::at_least(0));
  cell.hold_below_soc = root.quantity("hold_below_state_of_charge", "1", Limits::between(0, 1));
  const double ohms = root.quantity("resistance_factor", "1", Limits::positive());
  const double farads = root.quantity("capacitance_factor", "1", Limits::positive());

  cell.open_circuit_v = Curve::read(root, "open_circuit_voltage", "V");
  check_open_circuit(root, cell.open_circuit_v);
  const auto element = [&](const char* key, const char* unit, double factor) {
    const Curve curve = Curve::read(root, key, unit);
    check_positive(root, key, curve, cell.hold_below_soc);
    return curve.scaled(factor);
  };
  cell.series_ohm = element("series_resistance", "Ohm", ohms);
  cell.pair1_ohm = element("pair1_resistance", "Ohm", ohms);
  cell.pair1_farad = element("pair1_capacitance", "F", farads);
  cell.pair2_ohm = element("pair2_resistance", "Ohm", ohms);
  cell.pair2_farad = element("pair2_capacitance", "F", farads);

  const double full_v = cell.open_circuit_v(1);
  if (cell.cut_off_voltage_v >= full_v) {
    root.fail("cut_off_voltage", fmt::format("= {} V must be below the full cell's open-circuit voltage, {} V",
                                             cell.cut_off_voltage_v, full_v));
  }
  return cell;
}

double terminal_current_a(double source_v, double series_ohm, double power_w) {
  const double discriminant = source_v * source_v - 4 * series_ohm * power_w;
  if (discriminant <= 0) return source_v / (2 * series_ohm);
  // 2 P / (E + sqrt(...)) is (E - sqrt(...)) / (2 R) without the difference of two nearly equal numbers.
  return 2 * power_w / (source_v + std::sqrt(discriminant));
}

double power_limit_w(double source_v, double series_ohm, double cut_off_v) {
  // Below half the source voltage the terminal voltage has no stable point: the most is E^2 / (4 R).
  const double lowest_v = std::max(cut_off_v, source_v / 2);
  return lowest_v * (source_v - lowest_v) / series_ohm;
}

}  // namespace mebots::battery
